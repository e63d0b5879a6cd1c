"""``python -m safestart_service``: the same as ``safestart serve``."""

from __future__ import annotations

import sys

from safestart.cli import main

if __name__ == "__main__":
    sys.argv[1:1] = ["serve"]
    main()
