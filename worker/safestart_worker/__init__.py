"""Claims safestart jobs with a lease and runs them on Dask."""
