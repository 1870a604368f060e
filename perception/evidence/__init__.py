"""The observer's constants inferred from published evidence."""
