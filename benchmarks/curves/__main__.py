"""``python -m benchmarks.curves FOLDER [NAME ...]``: the same as ``safestart bench --curves FOLDER``, or some of it."""

import sys
from pathlib import Path

from benchmarks.curves.written import write

if __name__ == "__main__":
    write(Path(sys.argv[1]), sys.argv[2:], say=print)
