"""thermicon.circuit.delivery: devices and drive files."""
