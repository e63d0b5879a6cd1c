"""The record of work apart from the database: artifacts, bundles, provenance, and the comparison of results."""
