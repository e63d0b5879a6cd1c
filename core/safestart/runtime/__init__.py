"""What every process of the operating system needs: settings, logs, progress, caches, warm-up, supervision."""
