"""The hopping process: one approach planned and proved, and a study of what becomes of it under noise."""
