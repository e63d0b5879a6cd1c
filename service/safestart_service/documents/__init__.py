"""The documents in the service's answers."""
