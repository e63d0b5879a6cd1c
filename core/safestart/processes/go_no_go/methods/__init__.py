"""How go-no-go is answered: one method per file, by name in ``method_registry``."""
