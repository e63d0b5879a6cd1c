"""Verdicts aboard: certificate, atlas and thrust check of operating points as C99 without allocation."""
