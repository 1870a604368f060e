"""Reports as HTML pages, and the server of the page."""
