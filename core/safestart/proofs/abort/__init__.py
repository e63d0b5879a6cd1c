"""Checker of missed-burn proofs (``safestart-abort-proof/1``) in ball arithmetic; it shares no code with the prover."""
