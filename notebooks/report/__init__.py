"""Text for people: messages, numbers, tables, sentences."""
