"""The Dask cluster that runs the jobs, and the code of its task processes."""
