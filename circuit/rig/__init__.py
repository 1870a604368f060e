"""thermicon.circuit.rig: rig files → module, heat sink, driver, contact, skin, uncertainty."""
