"""Why two icons are distinguishable: parts of the distance, reasons, published rules."""
