"""Files written whole or not at all, export folders, traces read back."""
