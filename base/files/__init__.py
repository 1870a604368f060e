"""Files: written whole or not at all, read with a limit of size, tables and records in them."""
