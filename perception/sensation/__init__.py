"""Receptor temperature → sensation → detection → percept."""
