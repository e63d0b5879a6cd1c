"""A flight table written: fixed code, numbers, vectors, the proofs they rest on, and the digests that tie them."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from hashlib import sha256
from importlib.resources import files
from pathlib import Path
from typing import Any

from safestart.atlas.survey import build
from safestart.errors import invalid
from safestart.exact.question import Question
from safestart.flight_table import table, vectors
from safestart.flight_table.evidence import proofs_of
from safestart.flight_table.literals import PRECISIONS
from safestart.flight_table.numbers import Point, point_of
from safestart.model.scenario import Scenario
from safestart.proofs.checker import check
from safestart.records.provenance import versions
from safestart.runtime.files.bounded import bytes_within
from safestart.runtime.files.whole import Whole
from safestart.runtime.plain_json import loads
from safestart.runtime.progress import Context

FIXED = ("safestart_flight.h", "safestart_flight.c", "safestart_selftest.c")
MOST_POINTS = 256
_ALONE = Context()


@dataclass(frozen=True, slots=True)
class Exported:
    """The files of a flight table by name, and what is known of them (``manifest.json``)."""

    files: dict[str, bytes]
    manifest: dict[str, Any]

    def write(self, folder: Path) -> None:
        """Write every file into ``folder``, which is made where it is missing; none, where one cannot be written."""
        folder.mkdir(exist_ok=True)
        with Whole() as files:
            for name, data in self.files.items():
                files.add(folder / name, data)


def points_of(
    scenarios: Sequence[Scenario], steps: int, dt: float, y_max: float, context: Context = _ALONE
) -> list[Point]:
    """The numbers of each scenario; starts at rest in LVLH. Raises ``InvalidInput`` for none or too many."""
    if not 1 <= len(scenarios) <= MOST_POINTS:
        raise invalid("scenarios", f"1 to {MOST_POINTS} operating points", len(scenarios))
    found = []
    for k, scenario in enumerate(scenarios):
        part = context.part(k, 1.0, len(scenarios), f"operating point {k + 1} of {len(scenarios)}")
        found.append(point_of(scenario, build(Question(scenario, dt, steps), y_max, context=part)))
    return found


def export(points: Sequence[Point], precision: str = "float64") -> Exported:
    """The files of a table in ``float64`` or ``float32``.

    Raises ``InvalidInput`` for another precision, ``ProofRejected`` where the checker refuses a proof.
    """
    if precision not in PRECISIONS:
        raise invalid("precision", f"one of {', '.join(PRECISIONS)}", precision)
    real = PRECISIONS[precision]
    code = {name: files(__package__).joinpath("c", name).read_bytes() for name in FIXED}
    proofs = [document for point in points for document in proofs_of(point)]
    made = {
        "safestart_table.c": table.source(points, real).encode(),
        "proofs.json": json.dumps(proofs, sort_keys=True, separators=(",", ":"), allow_nan=False).encode(),
    }
    digests = {name: sha256(data).hexdigest() for name, data in made.items()}
    made["safestart_table.h"] = table.header(points, real, digests).encode()
    made["safestart_vectors.h"] = vectors.header(points, real).encode()
    everything = {**code, **made}
    manifest = {
        "format": "safestart-flight-table/1",
        "precision": precision,
        "points": [_stated(point) for point in points],
        "proofs": len(proofs),
        "table_bytes": table.size(points, real),
        "operations": operations(points),
        "files": {name: sha256(data).hexdigest() for name, data in sorted(everything.items())},
        "provenance": versions(),
    }
    everything["manifest.json"] = (json.dumps(manifest, indent=2, allow_nan=False) + "\n").encode()
    return Exported(everything, manifest)


def operations(points: Sequence[Point]) -> dict[str, int]:
    """Bounds on the distances to a face, sectors, ceilings and samples that a call works through."""
    members = len(points[0].spatial.reach)
    return {
        "certify_distances": 3 * (3 + 5 * members),
        "certify_in_space_distances": 5 * (3 + 2 * 5 * members),
        "atlas_sectors": max(len(point.sectors) for point in points),
        "atlas_ceilings": max(len(point.ceilings) for point in points),
        "check_thrust_samples": points[0].atlas.question.steps * max(point.watch.samples for point in points),
    }


_MOST_BYTES = 256 * 1024 * 1024
"""Of each file of a table."""


def verify(folder: Path) -> int:
    """Check a written table: every file's digest, the header's, and every proof; the number of proofs.

    Raises ``InvalidInput`` where a file is another's, ``ProofRejected`` where a proof fails.
    """
    try:
        manifest = loads(_bytes(folder, "manifest.json"))
        listed = dict(manifest["files"])
    except (ValueError, KeyError, TypeError, RecursionError):
        raise invalid("manifest.json", "the manifest of a flight table", "something else") from None
    if not {*FIXED, "safestart_table.c", "safestart_table.h", "proofs.json"} <= listed.keys():
        raise invalid("manifest.json", "every file of a flight table", sorted(listed))
    for name, digest in listed.items():
        found = sha256(_bytes(folder, Path(name).name)).hexdigest()
        if found != digest:
            raise invalid(name, f"SHA-256 {digest}", found)
    header = _bytes(folder, "safestart_table.h").decode(errors="replace")
    for name in ("safestart_table.c", "proofs.json"):
        if listed[name] not in header:
            raise invalid("safestart_table.h", f"the SHA-256 of {name}", "another")
    try:
        proofs = loads(_bytes(folder, "proofs.json"))
    except (ValueError, RecursionError):
        proofs = None
    if not isinstance(proofs, list):
        raise invalid("proofs.json", "a list of proofs", "something else")
    for document in proofs:
        check(document)
    return len(proofs)


def _stated(point: Point) -> dict[str, Any]:
    target, question = point.scenario.target, point.atlas.question
    shape = point.scenario.corridor
    return {
        "tumble_rate_rad_s": target.tumble_rate,
        "mean_motion_rad_s": target.mean_motion,
        "max_acceleration_m_s2": point.scenario.chaser.max_acceleration,
        "corridor": {name: getattr(shape, name) for name in ("c_x", "c_z", "x0", "z0", "hold_radius")},
        "horizon_s": question.horizon,
        "y_max_m": point.atlas.y_max,
        "relative_gap": point.atlas.relative_gap,
    }


def _bytes(folder: Path, name: str) -> bytes:
    return bytes_within(name, folder / name, _MOST_BYTES)
