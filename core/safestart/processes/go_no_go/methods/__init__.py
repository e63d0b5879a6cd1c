"""The methods of go-no-go: one per file, by name in ``method_registry``."""
