"""The benchmark process: certificate against engines."""
