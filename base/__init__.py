"""The ground floor: modules that all packages use."""
