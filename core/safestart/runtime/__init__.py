"""Needed by every operating-system process: settings, logs, progress, caches, warm-up, supervision."""
