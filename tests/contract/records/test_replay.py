"""Replays: equal bit for bit here, within a stated tolerance elsewhere, and differences are reported."""

from __future__ import annotations

import io
import json
from dataclasses import replace
from hashlib import sha256
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from safestart.errors import InvalidInput
from safestart.records.artifact import Artifact
from safestart.records.provenance import source_digest, versions
from safestart.records.replay import changed, differing, replay


def test_a_replay_here_is_the_same_bit_for_bit(execution: Any) -> None:
    found = replay(execution.document, {item.name: item.data for item in execution.artifacts})
    assert (found.verdict, found.kept, found.tolerance) == ("identical", True, None), found
    assert (found.environment, found.differences) == ((), ())


def test_a_replay_tells_what_differs_and_keeps_to_the_tolerance_elsewhere(execution: Any) -> None:
    files = {item.name: item.data for item in execution.artifacts}
    document = json.loads(json.dumps(execution.document))
    document["outputs"]["rows"][0]["area_m2"] *= 1 + 1e-12
    found = replay(document, files)
    assert (found.verdict, found.kept) == ("different", False)
    assert any("rows[0].area_m2" in line for line in found.differences)
    document["provenance"]["packages"]["numpy"] = "1.0"
    found = replay(document, files)
    assert (found.verdict, found.kept, found.tolerance) == ("within tolerance", True, 1e-9)
    assert any(line.startswith("numpy: 1.0 before") for line in found.environment)
    document["outputs"]["rows"][0]["area_m2"] *= 1 + 1e-6
    assert replay(document, files).kept is False
    assert replay(execution.document, files | {"x.npz": b""}).differences == (
        "artifact x.npz: not the one that the result names",
        "artifact x.npz: no longer produced",
    )


def test_a_replay_compares_what_a_store_would_give_back(
    execution: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Processes may leave numbers of NumPy in their outputs; JSON knows no difference."""
    stored = json.loads(json.dumps(execution.document))
    files = {item.name: item.data for item in execution.artifacts}
    outputs = dict(execution.document["outputs"], cell_area_m2=np.float64(stored["outputs"]["cell_area_m2"]))
    again = replace(execution, document=execution.document | {"outputs": outputs})
    monkeypatch.setattr("safestart.records.replay.execute", lambda *_: again)
    assert replay(stored, files).verdict == "identical"
    with pytest.raises(InvalidInput, match="required schema_version, process, inputs, outputs"):
        replay({"outputs": {}}, files)


def test_elsewhere_tables_and_documents_are_compared_by_value(
    execution: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    def table(*values: float) -> bytes:
        sink = io.BytesIO()
        pq.write_table(pa.table({"x": values}), sink)
        return sink.getvalue()

    def kept(name: str, before: bytes, now: bytes) -> bool:
        made = replace(execution, artifacts=(Artifact(name, "x/y", now),))
        monkeypatch.setattr("safestart.records.replay.execute", lambda *_: made)
        elsewhere["provenance"]["artifacts"] = {name: sha256(before).hexdigest()}
        return replay(elsewhere, {name: before}).kept

    elsewhere = json.loads(json.dumps(execution.document))
    elsewhere["provenance"]["packages"]["numpy"] = "1.0"
    nan = float("nan")
    assert kept("cases.parquet", table(1.0, nan), table(1.0 + 1e-13, nan))
    assert not kept("cases.parquet", table(1.0, 2.0), table(1.0, 2.1))
    assert kept("proof.json", b'{"a": [1.0]}', b'{"a": [1.0000000000001]}')
    assert not kept("proof.json", b'{"a": [1.0]}', b'{"a": [1.0, 2.0]}')


def test_a_changed_source_is_told_from_its_revision(tmp_path: Path) -> None:
    (tmp_path / "a.py").write_text("x = 1")
    first = source_digest(tmp_path)
    (tmp_path / "a.py").write_text("x = 2")
    second = source_digest(tmp_path)
    (tmp_path / "a.py").rename(tmp_path / "b.py")
    assert len({first, second, source_digest(tmp_path)}) == 3
    here = versions()
    assert changed(here, here) == ()
    assert changed(here | {"git_revision": None}, here) == (), "an installed package has no revision"
    assert len(changed(here | {"source_sha256": first}, here)) == 1
    old = {name: value for name, value in here.items() if name != "source_sha256"}
    assert changed(old, here) == ()
    assert len(changed(old | {"git_revision": None}, here)) == 1


def test_the_packages_that_compute_and_draw_are_on_record() -> None:
    computing = {"numpy", "scipy", "numba", "clarabel", "python-flint", "matplotlib", "pyarrow"}
    assert computing <= set(versions()["packages"])


def test_documents_differ_by_name_kind_and_length() -> None:
    assert differing({"a": 1}, {"a": 1.0}) == ["outputs.a: 1 before, 1.0 now"]
    assert differing({"a": [1]}, {"a": [1, 2]}) == ["outputs.a: [1] before, [1, 2] now"]
    assert differing({"a": 1}, {}) == ["outputs.a: 1 before, nothing now"]
    assert differing({}, {"a": None}) == ["outputs.a: nothing before, None now"]
    assert differing({"run_s": 1}, {"run_s": 2}) == []
    assert differing({"a": 1e6}, {"a": 1e6 + 1e-4}, 1e-9) == []
    assert differing({"a": 1e-12}, {"a": 2e-12}, 1e-9) == []
    assert len(differing({"a": True}, {"a": False}, 1e9)) == 1


def test_a_replay_says_what_was_asked_and_refuses_what_it_does_not_compare(execution: Any) -> None:
    """The outputs are compared with those of the inputs stated; a field beside them would go unread."""
    files = {item.name: item.data for item in execution.artifacts}

    def other(**change: Any) -> dict[str, Any]:
        return json.loads(json.dumps(execution.document)) | change

    process = execution.document["process"]
    for wrong in (
        {"note": "GO"},
        {"schema_version": 2},
        {"process": {}},
        {"process": process | {"x": 1}},
        {"provenance": {}},
    ):
        with pytest.raises(InvalidInput, match="result"):
            replay(other(**wrong), files)
    seed = other()
    seed["provenance"]["seed"] = 7
    assert replay(seed, files).differences == ("provenance.seed: 7 before, 0 now",)
    fewer = other()
    del fewer["inputs"]["rest"]
    assert any(line.startswith("inputs.rest") for line in replay(fewer, files).differences)
    hashed = other()
    name = next(iter(files))
    hashed["provenance"]["artifacts"][name] = "0" * 64
    assert replay(hashed, files).differences == (f"artifact {name}: not the one that the result names",)
    version = other(process=execution.document["process"] | {"version": "0.9"})
    assert any(line.startswith("process: ") for line in replay(version, files).environment)


def test_elsewhere_pictures_are_not_vouched_for(execution: Any) -> None:
    """A forged picture was within the tolerance on every other machine."""
    picture = next(item.name for item in execution.artifacts if item.name.endswith(".png"))
    files = {item.name: item.data for item in execution.artifacts} | {picture: b"forged"}
    document = json.loads(json.dumps(execution.document))
    document["provenance"]["artifacts"][picture] = sha256(b"forged").hexdigest()
    assert not replay(document, files).kept
    document["provenance"]["packages"]["numpy"] = "1.0"
    found = replay(document, files)
    assert (found.verdict, found.uncompared) == ("within tolerance", (picture,))


@pytest.mark.parametrize("name", ["a.npz", "a.json", "a.parquet"])
def test_elsewhere_what_cannot_be_read_is_different(
    execution: Any, monkeypatch: pytest.MonkeyPatch, name: str
) -> None:
    made = replace(execution, artifacts=(Artifact(name, "x/y", b"{}"),))
    monkeypatch.setattr("safestart.records.replay.execute", lambda *_: made)
    document = json.loads(json.dumps(execution.document))
    document["provenance"]["packages"]["numpy"] = "1.0"
    for data in (b"", b"{", b"PK\x03\x04", b'{"a": 1, "a": 1}'):
        document["provenance"]["artifacts"] = {name: sha256(data).hexdigest()}
        assert replay(document, {name: data}).differences == (f"artifact {name}: other content",)


def test_elsewhere_arrays_are_of_the_same_kind(execution: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    def archive(array: Any) -> bytes:
        target = io.BytesIO()
        np.savez(target, x=array)
        return target.getvalue()

    now, before = archive(np.ones(2)), archive(np.ones(2, dtype=np.float32))
    made = replace(execution, artifacts=(Artifact("a.npz", "x/y", now),))
    monkeypatch.setattr("safestart.records.replay.execute", lambda *_: made)
    document = json.loads(json.dumps(execution.document))
    document["provenance"] |= {"artifacts": {"a.npz": sha256(before).hexdigest()}, "python": "3.0"}
    assert not replay(document, {"a.npz": before}).kept
