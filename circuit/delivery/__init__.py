"""thermicon.circuit.delivery: devices, drive files and what comes with them."""
