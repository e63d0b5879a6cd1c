"""The record of work: jobs, results, artifacts, events. Only this package uses SQLAlchemy."""
