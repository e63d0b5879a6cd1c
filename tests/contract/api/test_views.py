"""Views of results: each path leads to something that the outputs have, and the description carries them all."""

from __future__ import annotations

import dataclasses
import re
import types
import typing
from pathlib import Path
from typing import Any

import pytest
from pydantic import BaseModel

import safestart_service
from safestart.engines.registry import ENGINES
from safestart.processes.base import ProcessSpec
from safestart.processes.registry import PROCESS_IDS, process
from safestart.processes.views import (
    Comparison,
    Facts,
    Findings,
    Flights,
    Matrices,
    Overlay,
    Picture,
    Rows,
    Scene,
)
from tests.contract.api.service_client import service

STATIC = Path(safestart_service.__file__).parent / "static"


def inner(kind: Any) -> Any:
    """The type without None."""
    if typing.get_origin(kind) in (typing.Union, types.UnionType):
        (kind,) = [one for one in typing.get_args(kind) if one is not type(None)]
    return inner(typing.get_args(kind)[0]) if typing.get_origin(kind) is typing.Annotated else kind


def step(kind: Any, part: str) -> Any:
    """The type behind one part of a path: a member, an entry of a list or object."""
    kind = inner(kind)
    if isinstance(kind, type) and issubclass(kind, BaseModel):
        members = {field.alias or name: field for name, field in kind.model_fields.items()}
        assert part in members, f"{kind.__name__} has no {part}"
        return members[part].annotation
    assert typing.get_origin(kind) in (dict, list), f"{kind} has no {part}"
    return typing.get_args(kind)[-1]


def follow(kind: Any, path: str) -> Any:
    for part in path.split(".") if path else []:
        kind = step(kind, part)
    return inner(kind)


def member(kind: Any, path: str) -> None:
    """A member of an input's entry, which is a model or a dataclass."""
    kind, (name, _, rest) = inner(kind), path.partition(".")
    if dataclasses.is_dataclass(kind):
        assert name in {field.name for field in dataclasses.fields(kind)}
    else:
        follow(step(kind, name), "*" if rest else "")


def check_column(spec: ProcessSpec, table: str, path: str) -> None:
    declared = {one.name: one for one in spec.tables}
    if table in declared:
        name, _, rest = path.partition(".")
        assert name in (*declared[table].columns, *declared[table].axes)
        follow(
            step(spec.outputs.model_fields[name].annotation, "*"),
            rest if name in declared[table].columns else "",
        )
        return
    parts = table.split(".") if table else []
    rows: Any = spec.outputs
    if len(parts) == 2 and typing.get_origin(follow(rows, parts[0])) is not list:
        follow(step(follow(rows, table), "*"), path)  # a list within an object
        return
    for depth, part in enumerate(parts):
        outer, rows = rows, step(step(rows, part), "*")
        if depth and not path.startswith(f"{part}."):
            rows = outer  # the outer row's values stand beside the inner one
        elif depth:
            path = path.removeprefix(f"{part}.")
    follow(rows, path)


@pytest.mark.parametrize("name", PROCESS_IDS)
def test_every_view_shows_what_the_outputs_have(name: str) -> None:
    spec = process(name)
    assert spec.views, "the result page of each process is declared"
    for view in spec.views:
        match view:
            case Findings():
                paths = [view.word, *(column.path for column in view.columns)]
                assert not set(view.good) & set(view.bad)
                for path in paths:
                    check_column(spec, view.table, path)
                follow(spec.outputs, view.basis)
            case Facts():
                for column in view.columns:
                    check_column(spec, "", column.path)
            case Rows():
                for column in view.columns:
                    check_column(spec, view.table, column.path)
            case Matrices():
                assert {"tp", "fp", "fn", "tn", "precision", "recall"} <= set(
                    follow(spec.outputs, view.path).model_fields
                )
                assert view.path.split(".").count("*") == len(view.names)
            case Overlay():
                for path in (view.by, "cells"):
                    check_column(spec, view.table, path)
                named = {one["name"] for one in spec.extensions.get("safestart:engines", [])}
                assert view.certain in named
            case Flights():
                case_model = follow(spec.outputs, f"{view.path}.*.*")
                for column in view.columns:
                    follow(case_model, column.path)
            case Scene():
                assert view.artifact.endswith(".npz")
            case Picture():
                for layer in view.layers:
                    assert bool(layer.value) == (layer.drawn in ("points", "positive", "heat"))
                    for path in filter(None, (layer.x, layer.y, layer.value)):
                        own = layer.beside and path.startswith(f"{layer.beside}.")
                        if own:  # of the input that belongs to the row
                            entry = step(spec.inputs.model_fields[layer.beside].annotation, "*")
                            member(entry, path.removeprefix(f"{layer.beside}."))
                        else:
                            check_column(spec, layer.table, path)
            case Comparison():
                for path in (view.by, *(measure.path for measure in view.measures), *view.logarithmic):
                    check_column(spec, view.table, path)


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


def test_javascript_names_no_process() -> None:
    """But for the calls that a page is about: Explore's, in the plane and in space, and the trade study's questions."""
    own = {
        "explore.js": {"safe-region"},
        "question.js": {"go-no-go"},
        "space.js": {"start-in-space", "region-in-space"},
        "trade.js": {"thrust-map"},
    }
    names = set(PROCESS_IDS) - {"flight", "certificate"}  # words of the trade as well
    for script in STATIC.rglob("*.js"):
        text = script.read_text()
        assert set(re.findall(r"""["'`]([a-z-]+)["'`]""", text)) & names <= own.get(script.name, set()), (
            script.name
        )
        assert not re.search(r"""process(ID)?\s*[!=]==?\s*["'`]""", text), script.name


def test_the_maps_colours_are_the_engines() -> None:
    style = (STATIC / "safestart.css").read_text()
    colours = {name: spec.screen_colour or spec.colour for name, spec in ENGINES.items()}
    assert f"--certified: {colours['certified']};" in style
    assert f"--exact: {colours['exact']};" in style
