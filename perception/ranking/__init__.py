"""The ranking of a set: people in batches, on several cores or machines, resumable."""
