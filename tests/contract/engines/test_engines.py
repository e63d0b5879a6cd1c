"""One contract, every engine, the same problems."""

import math
import re

import numpy as np
import pytest

from safestart.engines.base import Engine, EngineResult, Problem, ResultCode
from safestart.engines.hj.options import HamiltonJacobiInput
from safestart.engines.load import engine
from safestart.engines.registry import ENGINES
from safestart.errors import Cancelled, InvalidInput
from safestart.model.scenario import Chaser, CorridorShape, Grid, Rest, Scenario, SetKind, Target
from safestart.processes.wire import GridInput
from safestart.runtime.progress import Context

COARSE = {"hamilton_jacobi": HamiltonJacobiInput(nodes_xy=15, nodes_v=7)}
GRID = Grid(11, 9, 60.0)
OTHER_CORRIDOR = Scenario(
    Target(math.radians(2.0)), Chaser(0.05), CorridorShape(c_x=0.5, x0=1.0, hold_radius=2.0)
)

PROBLEMS = {
    "paper 1 deg/s": Problem(Scenario.of(1.0, 0.1), GRID, 20.0),
    "paper 3 deg/s, tube": Problem(Scenario.of(3.0, 0.1), GRID, 20.0, kind=SetKind.TUBE),
    "body rest": Problem(Scenario.of(3.0, 0.1), GRID, 20.0, rest=Rest.BODY),
    "no tumble": Problem(Scenario.of(0.0, 0.1), GRID, 20.0),
    "no orbit": Problem(Scenario.of(2.0, 0.1, mean_motion=0.0), GRID, 20.0),
    "other corridor": Problem(OTHER_CORRIDOR, Grid(7, 12, 40.0), 12.0),
}


def coarse(name: str) -> Engine:
    return engine(name, COARSE.get(name))


_solved: dict[tuple[str, str], EngineResult] = {}


def solve(name: str, problem: str) -> EngineResult:
    if (name, problem) not in _solved:
        _solved[name, problem] = coarse(name).solve(PROBLEMS[problem], Context())
    return _solved[name, problem]


@pytest.mark.parametrize("problem", PROBLEMS)
@pytest.mark.parametrize("name", ENGINES)
class TestEveryEngine:
    def test_result_is_well_formed(self, name: str, problem: str) -> None:
        result, posed = solve(name, problem), PROBLEMS[problem]
        shape = (posed.grid.ny, posed.grid.nx)
        assert result.code is ResultCode.OK, result.message
        assert result.mask is not None
        assert result.mask.dtype == np.bool_
        assert result.mask.shape == shape
        assert not (result.mask & ~posed.inside()).any(), "points outside the corridor are never safe"
        assert result.run_s > 0.0
        assert result.compile_s >= 0.0

    def test_margin_has_the_sign_of_the_mask(self, name: str, problem: str) -> None:
        result, posed = solve(name, problem), PROBLEMS[problem]
        if result.margin is None:
            assert name in ("forward", "tracking")
            return
        inside = posed.inside()
        assert result.mask is not None
        assert result.margin.shape == result.mask.shape
        assert np.isfinite(result.margin[inside]).all()
        assert (result.margin[result.mask] >= 0.0).all()
        assert (result.margin[inside & ~result.mask] <= 0.0).all()


# The slow engine is repeated once, the others on every problem.
REPEATED = [(n, p) for n in ENGINES for p in PROBLEMS if n != "hamilton_jacobi"]


@pytest.mark.parametrize(("name", "problem"), [*REPEATED, ("hamilton_jacobi", "paper 1 deg/s")])
def test_same_answer_again(name: str, problem: str) -> None:
    again = coarse(name).solve(PROBLEMS[problem], Context())
    np.testing.assert_array_equal(again.mask, solve(name, problem).mask)


@pytest.mark.parametrize("name", ENGINES)
def test_reports_progress_up_to_the_end(name: str) -> None:
    seen: list[float] = []
    coarse(name).solve(PROBLEMS["paper 1 deg/s"], Context(lambda done, total, _: seen.append(done / total)))
    assert seen == sorted(seen)
    assert seen[-1] == pytest.approx(1.0)
    assert all(0.0 <= value <= 1.0 + 1e-12 for value in seen)


@pytest.mark.parametrize("name", ENGINES)
def test_stops_when_dismissed(name: str) -> None:
    with pytest.raises(Cancelled):
        coarse(name).solve(PROBLEMS["paper 1 deg/s"], Context(cancelled=lambda: True))


@pytest.mark.parametrize("name", ENGINES)
def test_options_of_another_engine_are_refused(name: str) -> None:
    with pytest.raises(InvalidInput, match=f"options of {name}: required .*, received 'GridInput'"):
        engine(name, GridInput())


@pytest.mark.parametrize("name", ENGINES)
def test_what_is_known_of_an_engine_is_complete(name: str) -> None:
    spec = ENGINES[name]
    others = [other for other in ENGINES.values() if other is not spec]
    assert spec.name == name
    assert spec.title not in {other.title for other in others}
    assert spec.colour not in {other.colour for other in others}
    assert spec.document()["colour"] not in {other.document()["colour"] for other in others}
    assert re.fullmatch("#[0-9A-F]{6}", spec.document()["colour"])
    assert spec.summary


def test_unknown_engine_names_the_known_ones() -> None:
    with pytest.raises(InvalidInput, match="hamilton_jacobi"):
        engine("oracle")


@pytest.mark.parametrize(
    ("horizon", "dt"), [(0.0, 2.0), (math.nan, 2.0), (41.0, 2.0), (40.0, 0.0), (40.0, 80.0), (1e9, 2.0)]
)
def test_bad_horizons(horizon: float, dt: float) -> None:
    with pytest.raises(InvalidInput):
        Problem(Scenario.of(1.0, 0.1), GRID, horizon, dt)
