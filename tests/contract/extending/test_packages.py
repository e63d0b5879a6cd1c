"""The rules about folders and imports hold for what somebody adds, too: a new folder, a new engine, a new test."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[3]
PACKAGES = ("core/safestart", "service/safestart_service", "worker/safestart_worker")
CODE = (*PACKAGES, "tests", "benchmarks", "examples", "tools")
MOST_FILES, MOST_LINES = 14, 350


def folders(*roots: str) -> Iterator[tuple[str, list[Path]]]:
    """Folders that hold Python files, and these files."""
    for root in roots:
        for folder in (ROOT / root, *(ROOT / root).rglob("*/")):
            if files := sorted(folder.glob("*.py")):
                yield folder.relative_to(ROOT).as_posix(), files


def contracts() -> list[dict[str, Any]]:
    """The import rules."""
    found: list[dict[str, Any]] = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"][
        "importlinter"
    ]["contracts"]
    return found


def exceptions() -> set[str]:
    """The folders that docs/architecture.md names beside the rule."""
    text = (ROOT / "docs/architecture.md").read_text()
    (rule,) = re.findall(rf"^No folder of code holds more than {MOST_FILES} .*?(?=\n\n)", text, re.M | re.S)
    return set(re.findall(r"`([\w/]+)/`", rule))


def test_every_folder_with_code_is_a_package() -> None:
    """The import rules see packages only: a folder without ``__init__.py`` would work, ship and escape them all."""
    without = [name for name, files in folders(*PACKAGES) if not (ROOT / name / "__init__.py").exists()]
    assert without == [], "required: __init__.py in each"


def test_no_folder_grows_beyond_what_a_person_sees_at_once() -> None:
    allowed = exceptions()
    crowded = {
        name
        for name, files in folders(*CODE)
        if sum(file.name != "__init__.py" for file in files) > MOST_FILES
    }
    named = {name for name in crowded if any(f"/{name}".endswith(f"/{one}") for one in allowed)}
    assert crowded - named == set(), (
        f"required: at most {MOST_FILES} files, or a reason in docs/architecture.md"
    )
    assert len(named) == len(allowed), "each exception that the page names is still one"


def test_no_test_file_is_longer_than_one_reads() -> None:
    lines = {
        file.relative_to(ROOT).as_posix(): len(file.read_text().splitlines())
        for _, files in folders("tests")
        for file in files
    }
    assert {name: count for name, count in lines.items() if count > MOST_LINES} == {}


def test_jax_is_forbidden_to_every_module_but_one() -> None:
    """By whole packages, so that an engine of tomorrow is covered; ``lint-imports`` enforces the contract."""
    (contract,) = [
        one for one in contracts() if {"jax", "hj_reachability"} == set(one.get("forbidden_modules", ()))
    ]
    assert set(contract["source_modules"]) == {name.rpartition("/")[2] for name in PACKAGES}
    assert "allow_indirect_imports" not in contract
    importers = {ignored.partition(" -> ")[0] for ignored in contract["ignore_imports"]}
    assert importers == {"safestart.engines.hj.*", "safestart.levelset.adapter"}


def test_the_page_counts_the_exceptions_to_the_layers() -> None:
    (layers,) = [one for one in contracts() if one["type"] == "layers"]
    word = ("No", "One", "Two", "Three", "Four", "Five", "Six")[len(layers["ignore_imports"])]
    assert f"{word} exceptions have names" in (ROOT / "docs/architecture.md").read_text()
