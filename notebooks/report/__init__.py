"""Text for people: messages, numbers, tables and sentences."""
