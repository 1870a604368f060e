"""The observer: a model of a person with sourced constants."""
