"""The record of work: jobs, results, artifacts, events. SQLAlchemy lives here and nowhere else."""
