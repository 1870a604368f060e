"""What the command line prints: messages, numbers, tables, sentences."""
