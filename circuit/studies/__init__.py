"""thermicon.circuit.studies: studies of the source paper, the mesh and what a rig can reach."""
