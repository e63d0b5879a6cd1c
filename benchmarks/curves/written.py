"""Measures curves and writes what was found: ``curves.json``, ``curves.png``, ``curves.md``."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from benchmarks.curves.drawn import picture, table
from benchmarks.curves.fitted import fitted
from benchmarks.curves.measured import points
from benchmarks.curves.works import CURVES
from safestart.errors import invalid
from safestart.records.provenance import versions


def write(folder: Path, names: Sequence[str] = (), *, say: Callable[[str], Any]) -> dict[str, Any]:
    """Measure these curves (all by default). Those of a file that is there stay, unless they are measured again.

    Raises ``InvalidInput`` for a name that no curve has.
    """
    for name in names:
        if name not in CURVES:
            raise invalid("curve", " or ".join(CURVES), name)
    folder.mkdir(exist_ok=True)
    path = folder / "curves.json"
    found: dict[str, Any] = json.loads(path.read_text())["curves"] if path.exists() else {}
    for name in names or CURVES:
        measured = []
        for point in points(name):
            measured.append(point)
            say(f"{name}: {point['amount']:,}: {point['seconds']:.3g} s, {point['mib']:.0f} MiB")
        found[name] = {"points": measured, "exponents": fitted(measured)}
        ordered = {known: found[known] for known in CURVES if known in found}
        path.write_text(json.dumps({"curves": ordered, "machine": versions()["machine"]}, indent=1) + "\n")
    picture(ordered, folder / "curves.png")
    (folder / "curves.md").write_text(table(ordered))
    return ordered
