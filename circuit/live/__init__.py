"""thermicon.circuit.live: guarded play on a device that measures."""
