"""Jobs from submission to their results."""
