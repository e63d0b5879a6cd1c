"""Verdicts proved for every member of a family: intervals of the parameters and a box of starts."""
