"""thermicon.circuit.play: guards of a display that plays, the lines to it, and the script that is made of both."""
