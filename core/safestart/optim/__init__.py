"""Optimisation shared by exact answers and controllers: cone programs and projections."""
