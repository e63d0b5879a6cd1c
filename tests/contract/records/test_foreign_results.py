"""Results that no process makes: refused at import, and a problem in words where a database holds one."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from safestart.cli import build
from safestart.errors import UnfitResult
from safestart.records.bundle import Bundle, pack
from safestart.records.crate import pack_crate
from safestart.runtime.own_process import exit_code
from safestart.store.database import Database
from safestart.store.transfer import Transfer
from safestart_service.documents.formats.registry import BY_NAME
from tests.contract.api.service_client import assert_problem, url_of
from tests.contract.records.finished import done

ROW: dict[str, Any] = {"engine": 5, "code": None, "cells": "x", "area_m2": [1]}
FORGED: dict[str, tuple[dict[str, Any], str]] = {
    "a number for rows": ({"rows": 5}, "bundle.result.outputs.rows: required an array, received 5"),
    "numbers for rows": ({"rows": [1, 2]}, "bundle.result.outputs.rows.0: required an object, received 1"),
    "an object for rows": ({"rows": {"a": 1}}, "bundle.result.outputs.rows: required an array"),
    "nothing for rows": ({"rows": None}, "bundle.result.outputs.rows: required an array, received None"),
    "another row": ({"rows": [ROW]}, "bundle.result.outputs.rows.0.engine: required"),
    "text for a number": ({"cell_area_m2": "NaN"}, "bundle.result.outputs.cell_area_m2: required a number"),
    "a list for a number": ({"cell_area_m2": [1]}, "bundle.result.outputs.cell_area_m2: required a number"),
}
NEW_ID = "00000000-0000-4000-8000-000000000001"


@pytest.fixture
def kept(tmp_path: Path, execution: Any) -> Bundle:
    """A benchmark that ran, under an id that no database has."""
    database = Database(f"sqlite:///{tmp_path / 'origin.sqlite3'}")
    database.migrate()
    found = Transfer(database).read(done(database, execution))
    database.close()
    return replace(found, job=found.job | {"id": NEW_ID})


def forged(bundle: Bundle, *, version: str = "1.0.0", source: str | None = "", **outputs: Any) -> Bundle:
    """The same job with other outputs, of another version of its process, or of another source ("": the same)."""
    assert bundle.result is not None
    result = bundle.result | {"outputs": bundle.result["outputs"] | outputs}
    result |= {"process": result["process"] | {"version": version}}
    if source != "":
        result |= {"provenance": result["provenance"] | {"source_sha256": source}}
    return replace(bundle, result=result)


def imported(bundle: Bundle, folder: Path, capsys: pytest.CaptureFixture[str]) -> tuple[int, str]:
    file, url = folder / "job.zip", f"sqlite:///{folder / 'other.sqlite3'}"
    file.write_bytes(pack(bundle)[0])
    code = exit_code(lambda: build()(["import", str(file), "--database-url", url]))
    return code, capsys.readouterr().err


@pytest.mark.parametrize("source", ["", "0" * 64, None])
@pytest.mark.parametrize("what", FORGED)
def test_outputs_that_the_process_cannot_make_are_refused(
    kept: Bundle, what: str, source: str | None, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    outputs, said = FORGED[what]
    code, told = imported(forged(kept, source=source, **outputs), tmp_path, capsys)
    assert code == 2
    assert said in told
    assert not (tmp_path / "other.sqlite3").exists()


def test_a_result_of_another_version_of_ours_is_imported(
    kept: Bundle, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """It has a field more, one less, and a word that this version does not know; this very source has none of that."""
    assert kept.result is not None
    rows = [{**row, "elapsed": 1.0, "code": "new_word"} for row in kept.result["outputs"]["rows"]]
    for row in rows:
        del row["area_m2"]
    for source in ("0" * 64, None):
        code, told = imported(forged(kept, source=source, rows=rows, more=[1]), tmp_path, capsys)
        assert code == 0, told
        (tmp_path / "other.sqlite3").unlink()
    assert imported(forged(kept, rows=rows), tmp_path, capsys)[0] == 2


def test_a_result_of_another_process_version_is_read_by_its_values(
    kept: Bundle, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert imported(forged(kept, version="9.0.0", rows=[{"a": 1.5}]), tmp_path, capsys)[0] == 0


@pytest.mark.parametrize("version", ["1.0.0", "9.0.0"])
@pytest.mark.parametrize("what", FORGED)
def test_a_stored_result_that_does_not_fit_is_a_problem_in_words(
    queue, kept, what, version, tmp_path
) -> None:
    client, _ = queue
    Transfer(Database(url_of(tmp_path))).add(forged(kept, version=version, **FORGED[what][0]))
    for name in BY_NAME:
        answer = client.get(f"/jobs/{NEW_ID}/results?format={name}")
        if answer.status_code not in (200, 406):
            assert version == "9.0.0" or "outputs." in answer.json()["detail"]
            assert_problem(answer, 500)
            assert answer.json()["type"].endswith("unfit-result")
    assert client.get(f"/jobs/{NEW_ID}/results").status_code == 200, "the record shows what is stored"


@pytest.mark.parametrize("wrong", [{"packages": 5}, {"packages": {"numpy": [1]}}, {"source_sha256": 3}])
def test_a_stored_origin_that_is_none_is_a_problem_in_words(queue, kept, wrong, tmp_path) -> None:
    client, _ = queue
    stored = replace(kept, result=kept.result | {"provenance": kept.result["provenance"] | wrong})
    Transfer(Database(url_of(tmp_path))).add(stored)
    for path in ("prov", "bundle?format=ro-crate"):
        answer = client.get(f"/jobs/{NEW_ID}/{path}")
        assert_problem(answer, 500)
        assert answer.json()["detail"].startswith("provenance.")
    with pytest.raises(UnfitResult, match=r"^provenance"):
        pack_crate(stored)
