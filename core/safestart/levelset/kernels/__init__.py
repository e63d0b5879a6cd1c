"""The compiled kernels of the level-set solver."""
