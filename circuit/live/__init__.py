"""thermicon.circuit.live: exported icons played on a device that measures, guarded and logged."""
