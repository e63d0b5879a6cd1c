"""Run a stored job again and compare: bit for bit where promised, otherwise within a stated tolerance.

We promise equality bit for bit for the same source, the same versions of the computing packages, and the same
processor. Otherwise the last bits of floating-point sums may differ, and each process states its tolerance.
"""

from __future__ import annotations

import io
import json
import math
import zipfile
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from hashlib import sha256
from typing import Any, Literal

import numpy as np

from safestart.errors import invalid
from safestart.processes.execute import SCHEMA_VERSION, execute
from safestart.processes.registry import process
from safestart.records import parquet
from safestart.records.artifact import Artifact
from safestart.records.comparable import canonical, comparable
from safestart.runtime.plain_json import loads
from safestart.runtime.progress import Context

MOST_DIFFERENCES = 50
# Packages that do not affect results.
_NOT_COMPUTING = frozenset({"safestart-service", "safestart-worker", "distributed", "pydantic", "sqlalchemy"})
Verdict = Literal["identical", "within tolerance", "different"]


@dataclass(frozen=True, slots=True)
class Replay:
    """Outcome of a replay.

    ``kept`` says whether the promise was kept: identical where ``promise`` is bitwise (``tolerance`` None), within
    the tolerance otherwise. ``environment`` names what changed since, ``differences`` where the results differ, and
    ``uncompared`` the artifacts that the verdict does not cover: pictures with different bytes.
    """

    verdict: Verdict
    kept: bool
    tolerance: float | None
    environment: tuple[str, ...]
    differences: tuple[str, ...]
    uncompared: tuple[str, ...] = ()

    def document(self) -> dict[str, Any]:
        """JSON-able form."""
        return {"promise": "bitwise" if self.tolerance is None else "tolerance", **asdict(self)}


def replay(
    document: Mapping[str, Any], artifacts: Mapping[str, bytes], context: Context | None = None
) -> Replay:
    """Run the process of a result document again on its inputs and compare outputs and artifacts.

    ``artifacts`` are the stored files by name. Raises ``NotFound`` for a process that no longer exists and
    ``InvalidInput`` for inputs that it no longer accepts.
    """
    _require_result(document)
    process_id = document["process"]["id"]
    again = execute(process_id, process(process_id).stored(document["inputs"]), context)
    # As the store would return it, with NumPy numbers as plain numbers.
    now = json.loads(canonical(again.document))
    environment = changed(document["provenance"], now["provenance"])
    if document["process"] != now["process"]:
        environment += (f"process: {_shown(document['process'])} before, {_shown(now['process'])} here",)
    tolerance = process(process_id).replay_tolerance if environment else None
    files = {item.name: item for item in again.artifacts}
    # Inputs and seed must be equal, or the replay answers another question.
    asked = [
        *differing(document["inputs"], now["inputs"], path="inputs"),
        *_named(document["provenance"], now),
    ]
    asked += _hashes(document["provenance"]["artifacts"], artifacts)
    exact = [*asked, *differing(document["outputs"], now["outputs"]), *_files(artifacts, files, None)]
    if not exact:
        return Replay("identical", True, tolerance, environment, ())
    if tolerance is None:
        return Replay("different", False, None, environment, tuple(exact[:MOST_DIFFERENCES]))
    loose = [
        *asked,
        *differing(document["outputs"], now["outputs"], tolerance),
        *_files(artifacts, files, tolerance),
    ]
    shown = tuple((loose or exact)[:MOST_DIFFERENCES])
    pictures = [
        name for name, item in files.items() if _is_picture(name) and artifacts.get(name) != item.data
    ]
    verdict: Verdict = "different" if loose else "within tolerance"
    return Replay(verdict, not loose, tolerance, environment, shown, tuple(sorted(pictures)))


def _require_result(document: Mapping[str, Any]) -> None:
    """Raise ``InvalidInput`` for anything but a result; unknown fields would not be compared."""
    fields = {"schema_version", "process", "inputs", "outputs", "provenance"}
    missing = [name for name in sorted(fields) if name not in document]
    unknown = sorted(set(document) - fields)
    if missing or unknown:
        required = "schema_version, process, inputs, outputs and provenance"
        found = [f"no {name}" for name in missing] + [f"the unknown field {name!r}" for name in unknown]
        raise invalid("result", required, "; ".join(found))
    if document["schema_version"] != SCHEMA_VERSION:
        raise invalid("result.schema_version", str(SCHEMA_VERSION), document["schema_version"])
    made, source = document["process"], document["provenance"]
    if not isinstance(made, Mapping) or set(made) != {"id", "version"} or not isinstance(made["id"], str):
        raise invalid("result.process", "an object of id and version", made)
    if not isinstance(source, Mapping) or not isinstance(source.get("artifacts"), Mapping):
        raise invalid("result.provenance", "an object with artifacts", source)


def _named(before: Mapping[str, Any], now: Mapping[str, Any]) -> list[str]:
    seed = now["provenance"]["seed"]
    return [] if before.get("seed") == seed else [f"provenance.seed: {before.get('seed')} before, {seed} now"]


def _hashes(stated: Mapping[str, Any], artifacts: Mapping[str, bytes]) -> list[str]:
    """Stored artifacts that differ from those that the result names."""
    there = {name: sha256(data).hexdigest() for name, data in artifacts.items()}
    return [
        f"artifact {name}: not the one that the result names"
        for name in sorted({*there, *stated})
        if (name in stated, stated.get(name)) != (name in there, there.get(name))
    ]


def changed(before: Mapping[str, Any], now: Mapping[str, Any]) -> tuple[str, ...]:
    """Changes of the computing environment; empty where we promise equality bit for bit."""
    # Compare revisions only when the source hash is not on record: a revision does not show later changes.
    source = "source_sha256" if before.get("source_sha256") else "git_revision"
    pairs = [(name, before.get(name), now.get(name)) for name in (source, "python")]
    was, here = _object(before.get("machine")), _object(now.get("machine"))
    pairs += [(name, was.get(name), here.get(name)) for name in ("cpu", "architecture")]
    was, here = _object(before.get("packages")), _object(now.get("packages"))
    pairs += [(name, was.get(name), here.get(name)) for name in sorted({*was, *here} - _NOT_COMPUTING)]
    return tuple(
        f"{name}: {one} before, {two} here"
        for name, one, two in pairs
        if one != two or (name == source and one is None)
    )


def _object(value: Any) -> Mapping[str, Any]:
    return value if isinstance(value, Mapping) else {}


def differing(before: Any, now: Any, tolerance: float | None = None, path: str = "outputs") -> list[str]:
    """Where two documents differ, times aside.

    Numbers a, b count as equal when |a - b| <= ``tolerance`` max(1, |a|, |b|), or without a tolerance when a = b.
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
            found.append(f"artifact {name}: {'new' if name in now else 'no longer produced'}")
        elif before[name] != now[name].data and not _close(name, before[name], now[name].data, tolerance):
            found.append(f"artifact {name}: other content")
    return found


def _is_picture(name: str) -> bool:
    return name.endswith(".png")


def _close(name: str, before: bytes, now: bytes, tolerance: float | None) -> bool:
    """Compare arrays, tables and documents by value. Skip pictures: they show data that is compared already."""
    if tolerance is None:
        return False
    ending = name.rpartition(".")[2]
    if _is_picture(name):
        return True
    try:
        if ending == "json":
            return not differing(loads(before), loads(now), tolerance)
        if ending == "parquet":
            return not differing(_table(before), _table(now), tolerance)
        return ending == "npz" and _archives_close(before, now, tolerance)
    except (ValueError, RecursionError, OSError, EOFError, KeyError, zipfile.BadZipFile):
        # An unreadable file differs from the one written here.
        return False


def _table(data: bytes) -> Any:
    import pyarrow as pa

    try:
        table = parquet.read(data)
    except pa.ArrowException as error:
        raise ValueError(str(error)) from None
    return {"columns": [str(field) for field in table.schema], "rows": table.to_pydict()}


def _archives_close(before: bytes, now: bytes, tolerance: float) -> bool:
    with np.load(io.BytesIO(before)) as old, np.load(io.BytesIO(now)) as new:
        return sorted(old.files) == sorted(new.files) and all(
            old[key].shape == new[key].shape
            and old[key].dtype == new[key].dtype
            and _arrays_close(old[key], new[key], tolerance)
            for key in new.files
        )


def _arrays_close(one: np.ndarray, two: np.ndarray, tolerance: float) -> bool:
    if one.dtype.kind in "fc":
        return bool(np.allclose(one, two, rtol=tolerance, atol=tolerance, equal_nan=True))
    return bool(np.array_equal(one, two))
