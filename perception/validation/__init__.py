"""Published experiments simulated, and how far the predictions are from what was measured."""
