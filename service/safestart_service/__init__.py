"""The HTTP face of safestart: instant certificates, job submission, results, events, a dashboard."""
