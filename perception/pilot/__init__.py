"""A laboratory's own participants sharpen the prediction: what they answered, what it changes, what to measure next."""
