"""The record of work outside the database: artifacts, bundles, provenance, and the comparison of results."""
