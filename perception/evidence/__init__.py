"""The observer's constants inferred from published evidence: priors, experiments, likelihood, maximum, ablation."""
