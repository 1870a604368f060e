"""Results that draw themselves and are tables."""
