"""thermicon.circuit.studies: the source paper and the mesh, looked into."""
