"""The ranking of a set: people in parts, on several cores or machines, resumable."""
