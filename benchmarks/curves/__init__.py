"""What an answer costs, in time and memory, as it grows: ``safestart bench --curves FOLDER``."""
