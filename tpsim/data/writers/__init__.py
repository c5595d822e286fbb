"""One module for every kind of file that demonstrations and trials are written to."""
