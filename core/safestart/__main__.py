"""``python -m safestart``."""

from safestart.cli import main

main()
