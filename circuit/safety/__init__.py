"""thermicon.circuit.safety: limits, exposure, worst-case verdicts."""
