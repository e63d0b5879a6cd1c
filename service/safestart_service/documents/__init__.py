"""The documents that the service answers with."""
