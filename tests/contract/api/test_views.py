"""Views of results: each path leads to something that the outputs have, and the description carries them all."""

from __future__ import annotations

import re
from collections.abc import Iterable
from pathlib import Path

import pytest

import safestart_service
from safestart.engines.registry import ENGINES
from safestart.processes.registry import PROCESS_IDS, process
from safestart.processes.views import (
    Scene,
)
from tests.contract.api.service_client import service

STATIC = Path(safestart_service.__file__).parent / "static"


@pytest.mark.parametrize("name", PROCESS_IDS)
def test_every_result_page_is_declared(name: str) -> None:
    """What its views name is there: a process that names more cannot be declared (test_registrations.py)."""
    spec = process(name)
    assert spec.views
    assert all(view.artifact.endswith(".npz") for view in spec.views if isinstance(view, Scene))


def test_a_description_carries_views_tables_and_engines(tmp_path: Path) -> None:
    with service(tmp_path) as client:
        found = client.get("/processes/benchmark").json()
        kinds = {
            one["id"]: one["safestart:view_kinds"] for one in client.get("/processes").json()["processes"]
        }
        passive = client.get("/processes/passive-safety").json()
    assert found["safestart:engines"][0] == {
        "name": "certified",
        "title": "certified (sound)",
        "colour": "#009E73",
        "summary": ENGINES["certified"].summary,
    }
    assert [view["kind"] for view in found["safestart:views"]] == [
        "facts",
        "rows",
        "matrices",
        "overlay",
        "comparison",
    ]
    assert kinds["benchmark"] == found["safestart:view_kinds"]
    assert passive["safestart:views"][0]["kind"] == "findings"
    assert "safestart:engines" not in passive
    tables = process("safe-region").tables
    assert [one.name for one in tables] == ["inner_polygon_m", "outer_polygon_m"]


def named_in(script: str, ids: Iterable[str]) -> set[str]:
    """Ids in quotes; an id of one word, which may be a word for people, too, only where a script uses it as an id."""
    quoted = r"""["'`]"""
    used = r"""(?:(?:\bexecute\(|[^=]=|[!=]==?|\bid:)\s*["'`]|/processes/)"""
    return {
        name for name in ids if re.search((quoted if "-" in name else used) + name + r"""["'`/]""", script)
    }


def test_ids_are_told_from_words() -> None:
    status = 'job.dismissal_requested ? "stopping" : STATUS[job.status]; lines("flight", path)'
    assert named_in(status, ["stopping", "flight"]) == set()
    for used in ('execute("sweep", q)', 'const ID = "sweep";', 'one.id === "sweep"', '`/processes/sweep/execution`',
                 '{ id: "sweep" }'):  # fmt: skip
        assert named_in(used, ["sweep", "stopping"]) == {"sweep"}, used
    assert named_in('titles["safe-region"]', ["safe-region"]) == {"safe-region"}


def test_javascript_names_no_process() -> None:
    """But for the calls that a page is about: Explore's, in the plane and in space, and the trade study's questions."""
    own = {
        "explore.js": {"safe-region", "flight"},
        "question.js": {"go-no-go"},
        "space.js": {"start-in-space", "region-in-space"},
        "trade.js": {"thrust-map"},
    }
    for script in STATIC.rglob("*.js"):
        text = script.read_text()
        assert named_in(text, PROCESS_IDS) <= own.get(script.name, set()), script.name
        assert not re.search(r"""process(ID)?\s*[!=]==?\s*["'`]""", text), script.name


def test_the_maps_colours_are_the_engines() -> None:
    style = (STATIC / "safestart.css").read_text()
    colours = {name: spec.screen_colour or spec.colour for name, spec in ENGINES.items()}
    assert f"--certified: {colours['certified']};" in style
    assert f"--exact: {colours['exact']};" in style
