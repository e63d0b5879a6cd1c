"""The checker of proofs in space (schema ``safestart-proof/2``): attitude and motion by validated Taylor series."""
