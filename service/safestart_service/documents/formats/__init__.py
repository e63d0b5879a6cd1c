"""The formats of a stored result: one per file, listed in ``registry``."""
