"""Answers to the safe-start question that need no grid and no iteration."""
