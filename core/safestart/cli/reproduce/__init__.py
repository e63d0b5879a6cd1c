"""``safestart reproduce``: the papers' tables and figures, ours beside theirs."""
