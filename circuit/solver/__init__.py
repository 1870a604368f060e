"""thermicon.circuit.solver: corner points and a rig → drive current → temperatures → heat flow."""
