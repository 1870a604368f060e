"""The time line as data: an icon's run with its corners and events, and the frames that show them."""
