"""What the page for browsers asks of the server, and pages for the user of this computer alone."""
