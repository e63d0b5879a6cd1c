"""``python -m safestart_worker``: the worker command alone."""

from __future__ import annotations

import sys

from safestart.cli import main

if __name__ == "__main__":
    sys.argv[1:1] = ["worker"]
    main()
