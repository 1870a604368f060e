"""The observer: constants with sources, variants of the model, distributions of people."""
