"""The forms in which a stored result is given: one per file, listed in ``registry``."""
