"""A part that is registered wrongly is refused in one sentence: what was required, what was received."""

from __future__ import annotations

import sys
from types import ModuleType
from typing import Any

import pytest
from pydantic import Field

from safestart.engines.registry import ENGINES
from safestart.engines.spec import EngineSpec
from safestart.errors import InvalidInput, Misregistered, UnfitResult
from safestart.model.registry import by_name
from safestart.model.wire_model import WireModel
from safestart.processes import registry
from safestart.processes.base import ProcessSpec, Table
from safestart.processes.benchmark.spec import SPEC as BENCHMARK
from safestart.processes.benchmark.spec import _require_free
from safestart.processes.execute import execute
from safestart.processes.output import ProcessOutput
from safestart.processes.views import Column, Facts, Findings, Layer, Picture, Rows, View
from safestart.runtime.named import load
from safestart_service.documents.formats.base import Format
from safestart_service.documents.formats.registry import format_in

HERE = __name__


class State(WireModel):
    """One row."""

    verdict: str
    x_m: float


class Inputs(WireModel):
    """What is returned."""

    kind: str = "output"


class Outputs(WireModel):
    """A figure, rows and a curve."""

    closest_m: float = Field(0.0)
    states: list[State] = Field(default_factory=list)
    time_s: list[float] = Field(default_factory=list)


def spec(**changes: Any) -> ProcessSpec:
    plain: dict[str, Any] = {
        "id": "probe", "title": "Probe", "description": "A probe.", "inputs": Inputs, "outputs": Outputs,
        "run": f"{HERE}:run", "tables": (Table("curve", ("time_s",)),),
    }  # fmt: skip
    return ProcessSpec(**(plain | changes))


def run(inputs: Inputs, _: Any) -> Any:
    found: dict[str, Any] = {"closest_m": 1.0, "states": [], "time_s": []}
    return {"output": ProcessOutput(found), "dict": found, "none": None}[inputs.kind]


NOT_A_FUNCTION = 5


@pytest.mark.parametrize(
    ("target", "said"),
    [
        ("", "part: required module:name, received ''"),
        ("safestart.processes.drift.run", "part: required module:name, received 'safestart"),
        (None, "part: required module:name, received None"),
        ("safestart.nowhere:run", "part: required the name of a module, received 'safestart.nowhere'"),
        ("nowhere.at.all:run", "part: required the name of a module, received 'nowhere.at.all'"),
        (f"{HERE}:fly", f"part: required a function or class of {HERE}, received '{HERE}:fly'"),
        (f"{HERE}:NOT_A_FUNCTION", f"part: required a function or class of {HERE}"),
    ],
)
def test_a_name_that_leads_nowhere(target: Any, said: str) -> None:
    with pytest.raises(Misregistered) as refused:
        load(target, "part")
    assert refused.value.detail.startswith(said)


def test_what_a_named_module_itself_does_not_find_is_not_hidden(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "absent_library", None)
    with pytest.raises(ModuleNotFoundError, match="absent_library"):
        load("tests.unit.runtime.needs_more:run", "part")


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"run": ""}, "process probe: required run or sharding, received ''"),
        ({"id": "my probe"}, "id of a process: required small letters, digits and single hyphens, received"),
    ],
)
def test_a_process_that_cannot_run(changes: dict[str, Any], said: str) -> None:
    with pytest.raises(Misregistered, match=said):
        spec(**changes)


@pytest.mark.parametrize(
    ("made", "said"),
    [
        (None, "process probe: required a ProcessSpec named SPEC in probe_spec, received None"),
        (spec(id="other"), "process probe: required its id in probe_spec, received 'other'"),
    ],
)
def test_an_entry_without_its_process(made: Any, said: str, monkeypatch: pytest.MonkeyPatch) -> None:
    module = ModuleType("probe_spec")
    if made is not None:
        module.SPEC = made  # type: ignore[attr-defined]
    monkeypatch.setitem(sys.modules, "probe_spec", module)
    monkeypatch.setitem(registry._SPECS, "probe", "probe_spec")
    with pytest.raises(Misregistered, match=said):
        registry.process.__wrapped__("probe")


@pytest.mark.parametrize(("kind", "received"), [("dict", "dict"), ("none", "NoneType")])
def test_a_run_that_returns_something_else(kind: str, received: str, monkeypatch: pytest.MonkeyPatch) -> None:
    module = ModuleType("probe_spec")
    module.SPEC = spec()  # type: ignore[attr-defined]
    monkeypatch.setitem(sys.modules, "probe_spec", module)
    monkeypatch.setitem(registry._SPECS, "probe", "probe_spec")
    monkeypatch.setattr("safestart.processes.execute.process", registry.process.__wrapped__)
    assert execute("probe", {}).document["outputs"]["closest_m"] == 1.0
    with pytest.raises(UnfitResult, match=f"probe: required a ProcessOutput .* received {received}$"):
        execute("probe", {"kind": kind})


FIT: tuple[View, ...] = (
    Findings("Verdicts", "states", word="verdict", columns=(Column("x", "x_m"),)),
    Facts((Column("Closest", "closest_m"),)),
    Picture("Curve", "t", "t", (Layer("t", "line", "curve", "time_s", "time_s"),)),
)


def _drawn(**changes: Any) -> Picture:
    plain: dict[str, Any] = {"title": "t", "drawn": "line", "table": "curve", "x": "time_s", "y": "time_s"}
    return Picture("Curve", "t", "t", (Layer(**(plain | changes)),))


@pytest.mark.parametrize(
    ("view", "said"),
    [
        (Findings("V", "states", word="verdikt"), "required a column of table 'states', received 'verdikt'"),
        (Findings("V", "starts", word="verdict"), "required a table of the outputs, received 'starts'"),
        (Findings("V", "states", word="verdict", basis="proof"), "a column of the outputs, received 'proof'"),
        (Findings("V", "states", "verdict", good=("A",), bad=("A",)), "not good and bad at once"),
        (Facts((Column("Closest", "nearest_m"),)), "required a column of the outputs, received 'nearest_m'"),
        (Rows("R", "curve", (Column("x", "x_m"),)), "required a column of table 'curve', received 'x_m'"),
        (_drawn(drawn="curve"), "required drawn as one of line, area, .*, received 'curve'"),
        (_drawn(drawn="heat"), "required a value for a layer drawn as heat, received ''"),
        (_drawn(colour="red"), "required a colour of certified, .*, received 'red'"),
        (_drawn(table="curves"), "required a table of the outputs, received 'curves'"),
    ],
)
def test_a_view_of_what_is_not_there(view: View, said: str) -> None:
    assert spec(views=FIT).views == FIT
    with pytest.raises(Misregistered, match=f"{view.kind} among the views of process probe: .*{said}"):
        spec(views=(*FIT, view))


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        (
            {"name": "my engine"},
            "name of an engine: required small letters, digits and _, received 'my engine'",
        ),
        ({"colour": "red"}, "colour of engine probe: required #RRGGBB, received 'red'"),
        ({"screen_colour": "#12345"}, "colour of engine probe: required #RRGGBB"),
    ],
)
def test_an_engine_that_cannot_be_shown(changes: dict[str, Any], said: str) -> None:
    plain = {"name": "probe", "title": "t", "colour": "#000000", "engine": "a:B", "summary": "s"}
    with pytest.raises(Misregistered, match=said):
        EngineSpec(**(plain | changes))


@pytest.mark.parametrize("name", ["seed", "grid", "engines", "options", "model_dump"])
def test_an_engine_named_like_a_field_of_the_benchmark(name: str) -> None:
    _require_free(ENGINES)
    with pytest.raises(
        Misregistered, match=f"required no field of the benchmark's inputs, received '{name}'"
    ):
        _require_free([name])


def test_options_of_an_engine_that_is_not_asked_stay() -> None:
    """Who runs fewer engines of the same inputs need not take their options out."""
    asked = {"omega_t_deg_s": 3, "a_max_m_s2": 0.1, "engines": ["exact"]}
    parsed = BENCHMARK.parse(asked | {"backward": {"disturbance_m_s2": 0.001}})
    assert parsed.model_dump()["backward"]["disturbance_m_s2"] == 0.001


@pytest.mark.parametrize("name", ["two words", "", 5])
def test_a_name_with_blanks(name: Any) -> None:
    with pytest.raises(InvalidInput, match="things: required names without blanks, received"):
        by_name("things", [name], lambda one: one)


def test_a_media_type_that_is_none() -> None:
    with pytest.raises(
        Misregistered, match="media type of format probe: required type/subtype, received 'nonsense'"
    ):
        Format("probe", "nonsense", lambda record, table: b"")


@pytest.mark.parametrize(
    ("module", "said"),
    [
        ("base", "formats: required a Format named FORMAT in base.py, received None"),
        ("nowhere", "formats: required the name of a module, received 'safestart_service.documents"),
    ],
)
def test_a_module_without_a_format(module: str, said: str) -> None:
    with pytest.raises(Misregistered, match=said):
        format_in(module)
