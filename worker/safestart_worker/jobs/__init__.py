"""Run claimed jobs on the cluster."""
