"""One module for every kind of file: each has ``recordings(path) -> list[Recording]``."""
