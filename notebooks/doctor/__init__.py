"""What is installed, what is missing, and the cure: the checks of ``thermicon doctor``."""
