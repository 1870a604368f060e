"""thermicon.circuit.safety: drives → worst-case verdicts."""
