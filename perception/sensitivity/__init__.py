"""Which constants of the observer move a prediction most."""
