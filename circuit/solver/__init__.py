"""thermicon.circuit.solver: corner points and a rig → drive current, temperatures and heat flow."""
