"""The offered processes: one folder each with spec.py (light: inputs, outputs), run.py (imports its engines) and plots.py."""
