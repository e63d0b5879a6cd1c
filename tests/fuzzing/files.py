"""Mutants of what else is read: bundles, replayed results, atlas files. Hashes are written anew around each."""

from __future__ import annotations

import io
import json
import math
import zipfile
from collections.abc import Callable
from functools import cache
from hashlib import sha256
from random import Random
from typing import Any
from unittest.mock import patch

import numpy as np

from safestart.atlas.atlas import Atlas
from safestart.atlas.file import pack as pack_atlas
from safestart.atlas.file import unpack as open_atlas
from safestart.atlas.survey import build
from safestart.errors import SafestartError
from safestart.exact.question import Question
from safestart.model.scenario import Scenario
from safestart.processes.execute import Execution, execute
from safestart.processes.registry import process
from safestart.records.artifact import Artifact
from safestart.records.bundle import unpack as open_bundle
from safestart.records.comparable import TIMING_KEYS, digest
from safestart.records.replay import replay
from tests.fuzzing.documents import Run, names, tally
from tests.fuzzing.mutants import known_fields, mutants
from tests.fuzzing.plane.decided import Member, best
from tests.fuzzing.plane.printed import Printed

TIME = "2026-01-01T00:00:00+00:00"
FILE = Artifact("cells.json", "application/json", b'{"a": [1.0]}')
JOB: dict[str, Any] = {
    "id": "00000000-0000-4000-8000-000000000000",
    "process_id": "certificate",
    "status": "successful",
    "inputs": {"omega_t_deg_s": 3, "a_max_m_s2": 0.1},
    "instant": None,
    "attempts": 1,
    "timeout_s": 60.0,
    "priority": 0,
    "message": "done",
    "problem": None,
    "versions": {"python": "3"},
    "name": "before the burn",
    "tags": ["envisat"],
    "note": "as flown",
    **dict.fromkeys(("created_at", "started_at", "finished_at", "updated_at"), TIME),
}
EVENTS = [{"at": TIME, "kind": "status", "data": {"status": "successful"}}]
_FREE = {
    ("job", "inputs"),
    ("job", "instant"),
    ("job", "problem"),
    ("job", "versions"),
    ("events", "*", "data"),
} | {("result", name) for name in ("inputs", "outputs", "provenance")}
_SOME = 40


@cache
def _execution() -> Execution:
    made = execute("certificate", JOB["inputs"] | {"grid": {"nx": 3, "ny": 3}})
    document = json.loads(json.dumps(made.document))
    document["provenance"]["artifacts"] = {FILE.name: FILE.sha256}
    return Execution(document, (FILE,))


def _parts() -> dict[str, Any]:
    return {"job": JOB, "result": _execution().document, "events": EVENTS}


# --- bundles ---


def run_bundles(number: int, seed: int) -> Run:
    """Accepted is one of which every part is read, and whose parts say the same of the same job."""
    rng, parts = Random(f"bundle {seed}"), _parts()
    made = mutants(parts, known_fields(parts, {"position_half_width_m": [1.0]}), rng, number)
    return tally((done, mutant, _bundle_outcome(mutant)) for done, mutant in made)


def _bundle_outcome(parts: Any) -> str:
    try:
        files = {f"{name}.json": json.dumps(parts[name]).encode() for name in parts}
        files["artifacts/" + FILE.name] = FILE.data
        manifest = {
            "format": "safestart-bundle",
            "version": 1,
            "job": parts["job"]["id"],
            "result_sha256": digest(parts["result"]),
            "files": {n: {"sha256": sha256(d).hexdigest(), "size": len(d)} for n, d in files.items()},
            "media_types": {FILE.name: FILE.media_type},
        }
        files["manifest.json"] = json.dumps(manifest).encode()
    except (TypeError, ValueError, KeyError, AttributeError, RecursionError):
        return "no bundle"
    target = io.BytesIO()
    with zipfile.ZipFile(target, "w") as archive:
        for name, data in files.items():
            archive.writestr(name, data)
    try:
        found = open_bundle(target.getvalue())
    except SafestartError:
        return "rejected"
    read = {"job": found.job, "result": found.result, "events": found.events}
    if read != json.loads(json.dumps(parts)) or _closed(names(read)) - _closed(names(_parts())):
        return "accepted: unread"
    assert found.result is not None
    used, made = found.result["inputs"], found.result["provenance"]["artifacts"]
    true = found.job["process_id"] == found.result["process"]["id"] and made == {FILE.name: FILE.sha256}
    true = true and all(
        name in used and _equal(value, used[name]) for name, value in found.job["inputs"].items()
    )
    return "accepted: the same job" if read == _parts() else f"accepted: {'another job' if true else 'false'}"


def _closed(found: set[tuple[str, ...]]) -> set[tuple[str, ...]]:
    return {path for path in found if not any(path[: len(free)] == free and path != free for free in _FREE)}


def _equal(one: Any, two: Any) -> bool:
    return bool(one == two) and isinstance(one, bool) is isinstance(two, bool)


# --- replay ---


def run_replays(number: int, seed: int) -> Run:
    """Only bundles with the inputs, outputs and files of the same computation are kept."""
    rng, document = Random(f"replay {seed}"), _execution().document
    made = mutants(document, known_fields(_parts()), rng, number)
    with patch("safestart.records.replay.execute", _again):
        return tally((done, mutant, _replay_outcome(mutant)) for done, mutant in made)


def _again(process_id: str, inputs: Any, context: Any = None) -> Execution:
    """What a run would give, without running it: the same inputs give the same result."""
    if process(process_id).id != "certificate":
        raise SafestartError("another process")
    parsed = process(process_id).parse(inputs).model_dump(mode="json")
    if parsed != _execution().document["inputs"]:
        raise SafestartError("another question")
    return _execution()


def _replay_outcome(document: Any) -> str:
    try:
        document = json.loads(json.dumps(document, allow_nan=False))
    except (TypeError, ValueError):
        return "no JSON"
    try:
        found = replay(document, {FILE.name: FILE.data})
    except SafestartError:
        return "rejected"
    if not found.kept:
        return "rejected"
    same = _execution().document
    fields = {"schema_version", "process", "inputs", "outputs", "provenance"}
    if set(document) != fields or set(document["process"]) - {"id", "version"}:
        return "accepted: unread"
    close = 0.0 if found.tolerance is None else found.tolerance
    true = document["process"]["id"] == same["process"]["id"] and _like(
        document["inputs"], same["inputs"], 0.0
    )
    true = true and _like(document["outputs"], same["outputs"], close)
    true = true and (found.verdict != "identical" or _like(document["outputs"], same["outputs"], 0.0))
    true = true and document["provenance"]["artifacts"] == same["provenance"]["artifacts"]
    return f"accepted: {found.verdict}" if true else "accepted: false"


def _like(one: Any, two: Any, tolerance: float) -> bool:
    if isinstance(one, dict) and isinstance(two, dict):
        keys = {key for key in {*one, *two} if key not in TIMING_KEYS}
        return all(key in one and key in two and _like(one[key], two[key], tolerance) for key in keys)
    if isinstance(one, list) and isinstance(two, list):
        return len(one) == len(two) and all(_like(a, b, tolerance) for a, b in zip(one, two, strict=True))
    if isinstance(one, float) and isinstance(two, float) and tolerance:
        return abs(one - two) <= tolerance * max(1.0, abs(one), abs(two))
    return type(one) is type(two) and bool(one == two)


# --- atlas files ---

_INTEGERS = ("rows", "faces")


@cache
def _atlas() -> Atlas:
    return build(Question(Scenario.of(3.0, 0.05), 2.0, 4), 20.0, 0.1)


@cache
def _starts() -> Any:
    rng = np.random.default_rng(7)
    return rng.uniform([-40.0, 0.0], [40.0, 20.0], (_SOME, 2))


@cache
def _brackets(rate: float, n: float, a_max: float, shape: tuple[float, ...], dt: float, steps: int) -> Any:
    """(S, 2): what the margin of each start is, at least and at most, by another solver."""
    c_x, x0, hold = shape
    claim = Printed(
        *("NO_GO", -1.0, "one", 2, (steps, steps), dt, hold, ((c_x, x0),)),
        *((rate, rate), (n, n), (a_max, a_max), (0.0,) * 4, (0.0,) * 4),
    )
    out = []
    for x, y in _starts().tolist():
        upper, lower, _ = best(claim, [Member(rate, n, a_max, (x, y, 0.0, 0.0))], steps)
        out.append((lower, upper))
    return np.array(out)


def _true(atlas: Atlas) -> bool:
    question = atlas.question
    target, shape = question.scenario.target, question.scenario.corridor
    known = _brackets(
        *(target.tumble_rate, target.mean_motion, question.scenario.chaser.max_acceleration),
        *((shape.c_x, shape.x0, shape.hold_radius), question.dt, question.steps),
    )
    lower, upper = atlas.bounds(_starts())
    return bool((lower <= known[:, 1] + 1e-5).all() and (upper >= known[:, 0] - 1e-5).all())


def run_atlases(number: int, seed: int) -> Run:
    """Accepted is only an atlas whose bounds hold at all starts tried."""
    rng = Random(f"atlas {seed}")
    with np.load(io.BytesIO(pack_atlas(_atlas()))) as found:
        document = {name: found[name].tolist() for name in found.files}
    document["head"] = json.loads(document["head"])
    made = mutants(document, known_fields(document), rng, number)
    return tally((done, mutant, _atlas_outcome(mutant)) for done, mutant in made)


def _atlas_outcome(document: Any) -> str:
    try:
        arrays = {
            name: np.array(json.dumps(value, sort_keys=True))
            if name == "head"
            else np.array(value, dtype=np.int64 if name in _INTEGERS else np.float64)
            for name, value in document.items()
        }
        target = io.BytesIO()
        np.savez(target, allow_pickle=False, **arrays)
    except (TypeError, ValueError, OverflowError):
        return "no file"
    try:
        atlas = open_atlas(target.getvalue())
    except SafestartError:
        return "rejected"
    if not _true(atlas):
        return "accepted: false"
    same = pack_atlas(atlas) == pack_atlas(_atlas())
    stated = math.isclose(atlas.relative_gap, _atlas().relative_gap, abs_tol=1e-6)
    return f"accepted: {'the same atlas' if same else 'another true one' if stated else 'another gap, true'}"


FILES: dict[str, Callable[[int, int], Run]] = {
    "bundle": run_bundles,
    "replay": run_replays,
    "atlas": run_atlases,
}
