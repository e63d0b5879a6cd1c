"""The go-no-go process: verdicts for single starts."""
