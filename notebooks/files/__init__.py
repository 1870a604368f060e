"""Files of the command line and the workbench."""
