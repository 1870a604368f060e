"""Receptor temperature to sensation, detection and percept."""
