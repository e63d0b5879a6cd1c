"""The passive-abort process: the missed-burn proof for any plan of impulses."""
