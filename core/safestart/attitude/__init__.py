"""How the target turns."""
