"""thermicon.circuit.safety: limits, exposure, and a drive judged in its worst case."""
