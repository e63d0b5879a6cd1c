"""Proofs that hold against a bounded disturbance: a plan, a feedback, and the tube that the error stays in."""
