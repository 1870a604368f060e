"""The time line as data: an icon's run with its corners, events and measured log, and the frames that show them."""
