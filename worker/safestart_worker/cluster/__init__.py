"""The Dask cluster that jobs run on, and what runs in its task processes."""
