"""Flat names for a model: those of the objects that are opened, JSON for every other object."""

from __future__ import annotations

from typing import Annotated, Any, Literal

import pytest
import typer
from pydantic import Field
from typer.testing import CliRunner

from safestart.cli.options import takes
from safestart.errors import InvalidInput
from safestart.processes.base import WireModel
from safestart.processes.flat import Flat, described
from safestart.processes.go_no_go.one_start import ONE_START


class Shape(WireModel):
    c_x: float = Field(1.5, gt=0, description="Slope.")


class State(WireModel):
    x_m: float = Field(le=100, description="Position, m.")


class Spin(WireModel):
    kind: Literal["spin"]
    axis: list[float]


class Free(WireModel):
    kind: Literal["free"]
    rate: float


class Start(WireModel):
    position_m: list[float]


class Inputs(WireModel):
    """As the inputs of go-no-go will be: a short form, and optional objects beside it."""

    thrust: float
    mode: Literal["a", "b"] = "a"
    corridor: Shape = Field(default_factory=Shape)
    states: list[State] | None = Field(None, min_length=1)
    starts: list[Start] | None = None
    attitude: Annotated[Spin | Free, Field(discriminator="kind")] | None = Field(
        None, description="How it turns."
    )


class Short(WireModel):
    states: list[State]


FLAT = Flat(Inputs, {"corridor": Shape})
SHORT = Flat(Short, {"states": State})


def test_names_go_where_they_belong() -> None:
    assert list(FLAT.parameters) == ["thrust", "mode", "c_x", "states", "starts", "attitude"]
    found = FLAT.read({"thrust": "2", "c_x": "0.5", "attitude": '{"kind": "spin", "axis": [0, 0, 1]}'})
    assert found == Inputs(thrust=2, corridor=Shape(c_x=0.5), attitude=Spin(kind="spin", axis=[0, 0, 1]))
    found = FLAT.parse({"thrust": 2, "starts": [{"position_m": [5, 40, 0]}]})
    assert found == Inputs(thrust=2, starts=[Start(position_m=[5, 40, 0])])
    assert SHORT.read({"x_m": "5"}) == Short(states=[State(x_m=5)])


@pytest.mark.parametrize(
    ("flat", "values", "field"),
    [
        (FLAT, {}, "thrust"),
        (FLAT, {"thrust": "2", "c_x": "0"}, "c_x"),
        (FLAT, {"thrust": "2", "corridor": "{}"}, "corridor"),
        (FLAT, {"thrust": "2", "y_m": "1"}, "y_m"),
        (FLAT, {"thrust": "2", "attitude": "{"}, "attitude"),
        (FLAT, {"thrust": "2", "attitude": '{"kind": "spin", "axis": ["x"]}'}, "attitude.axis.0"),
        (SHORT, {}, "x_m"),
        (SHORT, {"x_m": "101"}, "x_m"),
        (SHORT, {"states": "[]"}, "states"),
    ],
)
def test_refusals_name_the_flat_field(flat: Flat[Any], values: dict[str, str], field: str) -> None:
    with pytest.raises(InvalidInput) as refused:
        flat.read(values)
    assert refused.value.field == field


def test_two_fields_of_one_name_are_refused() -> None:
    class Twice(WireModel):
        x_m: float
        states: list[State]

    with pytest.raises(ValueError, match="x_m"):
        Flat(Twice, {"states": State})


def test_the_description_is_the_model_s() -> None:
    found = described(FLAT.parameters, "Query", "Flat.").model_json_schema()
    assert found["required"] == ["thrust"]
    assert found["properties"]["c_x"]["description"] == "Corridor: slope."
    assert found["properties"]["attitude"]["type"] == "string"


def test_an_object_that_may_be_left_out_takes_its_fields_with_it() -> None:
    class Either(WireModel):
        shape: Shape | None = None
        state: State | None = None

    flat = Flat(Either, {"state": State})
    assert flat.parse({}) == Either()
    assert flat.parse({"x_m": 1}) == Either(state=State(x_m=1))
    assert "required" not in described(flat.parameters, "Query", "Flat.").model_json_schema()


def test_a_command_has_an_option_for_each_parameter() -> None:
    received: dict[str, Any] = {}
    app = typer.Typer()

    @app.command()
    @takes(FLAT.parameters, without=("states",))
    def command(*, loud: bool = False, **asked: Any) -> None:
        received.update(asked, loud=loud)

    line = ["--thrust", "2", "--attitude", '{"kind": "free", "rate": 1}', "--loud"]
    assert CliRunner().invoke(app, line).exit_code == 0
    assert received == {
        "thrust": 2.0,
        "mode": None,
        "c_x": None,
        "starts": None,
        "attitude": '{"kind": "free", "rate": 1}',
        "loud": True,
    }
    assert CliRunner().invoke(app, []).exit_code == 2, "thrust is required"
    assert CliRunner().invoke(app, ["--thrust", "2", "--states", "[]"]).exit_code == 2
    shown = CliRunner().invoke(app, ["--help"], terminal_width=200).output
    assert "[a|b]" in shown
    assert "How it turns." in shown


def test_go_no_go_asks_for_one_start_by_the_names_of_its_inputs() -> None:
    short = {"omega_t_deg_s": "3", "a_max_m_s2": "0.1", "x_m": "5", "y_m": "40"}
    assert {name for name, one in ONE_START.parameters.items() if one.required} == set(short)
    found = ONE_START.read(short | {"r_h_m": "1", "proofs": "true"})
    assert (found.states[0].x_m, found.states[0].z_m, found.corridor.r_h_m, found.proofs) == (
        5,
        None,
        1,
        True,
    )
