"""Run a stored job again and compare: bit for bit where that is promised, within a named tolerance elsewhere.

Bit for bit is promised for the same source, the same versions of the packages that compute, and the same processor.
Elsewhere the last bits of floating-point sums may differ, and each process names the tolerance it keeps to.
"""

from __future__ import annotations

import io
import json
import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any, Literal

import numpy as np

from safestart.errors import invalid
from safestart.processes.execute import execute
from safestart.processes.registry import process
from safestart.records.artifact import Artifact
from safestart.records.comparable import canonical, comparable
from safestart.runtime.progress import Context

MOST_DIFFERENCES = 50
# What has no part in a computation.
_NOT_COMPUTING = frozenset({"safestart-service", "safestart-worker", "distributed", "pydantic", "sqlalchemy"})
Verdict = Literal["identical", "within tolerance", "different"]


@dataclass(frozen=True, slots=True)
class Replay:
    """Outcome of a replay.

    ``kept`` says whether the promise was kept: identical where ``promise`` is bitwise (``tolerance`` None), within
    the tolerance elsewhere. ``environment`` names what is not as it was, ``differences`` where the results differ.
    """

    verdict: Verdict
    kept: bool
    tolerance: float | None
    environment: tuple[str, ...]
    differences: tuple[str, ...]

    def document(self) -> dict[str, Any]:
        """JSON-able form."""
        return {"promise": "bitwise" if self.tolerance is None else "tolerance", **asdict(self)}


def replay(
    document: Mapping[str, Any], artifacts: Mapping[str, bytes], context: Context | None = None
) -> Replay:
    """Run the process of a result document again on its inputs and compare outputs and artifacts.

    ``artifacts`` are the stored files by name. Raises ``NotFound`` for a process that is gone and ``InvalidInput``
    for inputs that it does not take any more.
    """
    missing = [name for name in ("process", "inputs", "outputs", "provenance") if name not in document]
    if missing:
        raise invalid("result", "process, inputs, outputs and provenance", f"none of {', '.join(missing)}")
    process_id = document["process"]["id"]
    again = execute(process_id, document["inputs"], context)
    # As the store would give it back: numbers of NumPy are plain ones there.
    outputs = json.loads(canonical(again.document["outputs"]))
    environment = changed(document["provenance"], again.document["provenance"])
    tolerance = process(process_id).replay_tolerance if environment else None
    files = {item.name: item for item in again.artifacts}
    exact = [*differing(document["outputs"], outputs), *_files(artifacts, files, None)]
    if not exact:
        return Replay("identical", True, tolerance, environment, ())
    if tolerance is None:
        return Replay("different", False, None, environment, tuple(exact[:MOST_DIFFERENCES]))
    loose = [
        *differing(document["outputs"], outputs, tolerance),
        *_files(artifacts, files, tolerance),
    ]
    shown = tuple((loose or exact)[:MOST_DIFFERENCES])
    return Replay("different" if loose else "within tolerance", not loose, tolerance, environment, shown)


def changed(before: Mapping[str, Any], now: Mapping[str, Any]) -> tuple[str, ...]:
    """What of the environment that computes is not as it was; empty where bit for bit is promised."""
    # The revision only stands in for the source where that is not on record: it does not tell what was changed since.
    source = "source_sha256" if before.get("source_sha256") else "git_revision"
    pairs = [(name, before.get(name), now.get(name)) for name in (source, "python")]
    was, here = before.get("machine", {}), now.get("machine", {})
    pairs += [(name, was.get(name), here.get(name)) for name in ("cpu", "architecture")]
    was, here = before.get("packages", {}), now.get("packages", {})
    pairs += [(name, was.get(name), here.get(name)) for name in sorted({*was, *here} - _NOT_COMPUTING)]
    return tuple(
        f"{name}: {one} before, {two} here"
        for name, one, two in pairs
        if one != two or (name == source and one is None)
    )


def differing(before: Any, now: Any, tolerance: float | None = None, path: str = "outputs") -> list[str]:
    """Where two documents differ, times aside.

    Numbers a, b count as equal when |a - b| <= ``tolerance`` max(1, |a|, |b|); without a tolerance, when they are.
    """
    return list(_walk(comparable(before), comparable(now), tolerance, path))


def _walk(before: Any, now: Any, tolerance: float | None, path: str) -> list[str]:
    if isinstance(before, dict) and isinstance(now, dict):
        keys = [*before, *(key for key in now if key not in before)]
        missing = object()
        return [
            line
            for key in keys
            for line in _walk(before.get(key, missing), now.get(key, missing), tolerance, f"{path}.{key}")
        ]
    if isinstance(before, list) and isinstance(now, list) and len(before) == len(now):
        pairs = enumerate(zip(before, now, strict=True))
        return [line for i, (a, b) in pairs for line in _walk(a, b, tolerance, f"{path}[{i}]")]
    if _equal(before, now, tolerance):
        return []
    return [f"{path}: {_shown(before)} before, {_shown(now)} now"]


def _equal(before: Any, now: Any, tolerance: float | None) -> bool:
    if tolerance is not None and isinstance(before, float) and isinstance(now, float):
        close = math.isclose(before, now, rel_tol=tolerance, abs_tol=tolerance)
        return close or (math.isnan(before) and math.isnan(now))
    return type(before) is type(now) and bool(before == now)


def _shown(value: Any) -> str:
    text = "nothing" if type(value) is object else repr(value)
    return text if len(text) <= 60 else text[:57] + "..."


def _files(before: Mapping[str, bytes], now: Mapping[str, Artifact], tolerance: float | None) -> list[str]:
    found = []
    for name in sorted({*before, *now}):
        if name not in before or name not in now:
            found.append(f"artifact {name}: {'new' if name in now else 'not made any more'}")
        elif before[name] != now[name].data and not _close(name, before[name], now[name].data, tolerance):
            found.append(f"artifact {name}: other content")
    return found


def _close(name: str, before: bytes, now: bytes, tolerance: float | None) -> bool:
    """Arrays, tables and documents by value; pictures are drawn from what is compared already."""
    if tolerance is None:
        return False
    ending = name.rpartition(".")[2]
    if ending == "png":
        return True
    if ending == "json":
        return not differing(json.loads(before), json.loads(now), tolerance)
    if ending == "parquet":
        return not differing(_table(before), _table(now), tolerance)
    if ending != "npz":
        return False
    with np.load(io.BytesIO(before)) as old, np.load(io.BytesIO(now)) as new:
        return set(old.files) == set(new.files) and all(
            old[key].shape == new[key].shape and _arrays_close(old[key], new[key], tolerance)
            for key in old.files
        )


def _table(data: bytes) -> Any:
    import pyarrow.parquet as pq

    return pq.read_table(io.BytesIO(data)).to_pydict()


def _arrays_close(one: np.ndarray, two: np.ndarray, tolerance: float) -> bool:
    if one.dtype.kind in "fc":
        return bool(np.allclose(one, two, rtol=tolerance, atol=tolerance, equal_nan=True))
    return bool(np.array_equal(one, two))
