"""thermicon.circuit.play: guarded players of exported drives."""
