"""A pilot experiment: observed answers, the conditioned prediction, the plan of the next measurement."""
