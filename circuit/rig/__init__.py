"""thermicon.circuit.rig: rig files → everything between the drive and the receptors."""
