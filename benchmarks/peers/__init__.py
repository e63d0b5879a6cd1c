"""The peers: what a user would reach for without safestart, at its best."""
