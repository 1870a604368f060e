"""thermicon.circuit.rig: rig files → module, heat sink, driver, contact, skin and what is uncertain of them."""
