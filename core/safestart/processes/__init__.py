"""The offered processes, one folder each.

``spec.py`` is light (inputs, outputs, description), ``run.py`` imports its engines, ``plots.py`` draws.
"""
