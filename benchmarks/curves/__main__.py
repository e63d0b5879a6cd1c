"""``python -m benchmarks.curves FOLDER [NAME ...]``: the same as ``safestart bench --curves FOLDER``, or some of it."""

from pathlib import Path

from benchmarks.asked import parser

if __name__ == "__main__":
    asked = parser(__doc__)
    asked.add_argument("folder", type=Path)
    asked.add_argument("names", nargs="*", metavar="NAME", help="curves to measure; all by default")
    given = asked.parse_args()
    # Imported here: the help need not wait for what draws.
    from benchmarks.curves.written import write

    write(given.folder, given.names, say=print)
