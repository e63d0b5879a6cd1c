"""Closed-loop encounters of two satellites: pilots, adversaries, supervisor."""
