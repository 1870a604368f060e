"""Icons as figures and small pictures; what is drawn is imported for its type alone."""
