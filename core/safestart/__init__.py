"""safestart: may this chaser start its approach to that tumbling target?"""

__version__ = "0.1.0"
