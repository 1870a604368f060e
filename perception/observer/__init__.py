"""The observer: constants with sources, variants of the model, and people drawn around it."""
