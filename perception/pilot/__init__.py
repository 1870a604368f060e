"""A pilot experiment: the prediction conditioned on its answers and the plan of the next one."""
