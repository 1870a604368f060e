"""The ground floor: modules that all packages use, and that know none of them."""
