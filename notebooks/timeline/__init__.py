"""The time line as data: an icon's run with corners, events, frames."""
