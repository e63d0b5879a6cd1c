"""The Hamilton-Jacobi engine: model against CWH, value bounds, the exact set, failure, cancellation, bad input."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from safestart.engines import hamilton_jacobi
from safestart.engines.base import EngineResult, Problem, ResultCode
from safestart.engines.hamilton_jacobi import HamiltonJacobi
from safestart.engines.hj import domain as hj_domain
from safestart.engines.hj import fused, peer
from safestart.engines.hj.frame import Frame
from safestart.engines.hj.options import Accuracy, HamiltonJacobiInput
from safestart.engines.hj.target import TargetValues
from safestart.errors import Cancelled, InvalidInput
from safestart.model.scenario import Grid, Rest, Scenario, SetKind
from safestart.processes.registry import process
from safestart.runtime.progress import Context
from tests.unit.sets.exact_margin import reach_margin

SMALL = {"nodes_xy": 21, "nodes_v": 9}
GRID = Grid(21, 21, 40.0)


def run(
    rate: float = 3.0,
    horizon: float = 10.0,
    grid: Grid = GRID,
    rest: Rest = Rest.LVLH,
    kind: SetKind = SetKind.TUBE,
    context: Context | None = None,
    match: float | None = None,
    **options: Any,
) -> EngineResult:
    """The first-order scheme on a small grid, unless the options say otherwise."""
    asked = HamiltonJacobiInput.model_validate({"accuracy": "low"} | SMALL | options)
    problem = Problem(Scenario.of(rate, 0.1), grid, horizon, rest=rest, kind=kind)
    return HamiltonJacobi(asked, match=match).solve(problem, context or Context())


@pytest.mark.parametrize("frame", list(Frame))
@pytest.mark.parametrize(("rest", "rate"), [(Rest.LVLH, 0.0), (Rest.LVLH, 3.0), (Rest.BODY, 3.0)])
def test_bounds_and_inclusions(
    rest: Rest, rate: float, frame: Frame, monkeypatch: pytest.MonkeyPatch
) -> None:
    """V in l's range, a tube that grows with the horizon, the fixed-time set in it, all inside the corridor."""
    tube = run(rate, 12.0, rest=rest, frame=frame.value)
    fixed = run(rate, 12.0, rest=rest, kind=SetKind.FIXED, frame=frame.value)
    inside = Problem(Scenario.of(rate, 0.1), GRID).inside()
    for result in (tube, fixed):
        assert result.code is ResultCode.OK, result.message
        assert result.detail["frame"] == frame.value
        assert result.mask is not None
        assert not (result.mask & ~inside).any()
        detail = result.detail
        spread = detail["target_max_m"] - detail["target_min_m"]
        assert detail["value_min_m"] >= detail["target_min_m"] - 1e-3 * spread
        assert detail["value_max_m"] <= detail["target_max_m"] + 1e-3 * spread
    np.testing.assert_array_equal(tube.mask, inside, err_msg="a tube contains its target")
    # The automatic box grows with the horizon; one box for all makes the values comparable.
    box = hj_domain.Domain(np.array([90.0, 90.0, 6.0, 6.0]), 12.0)
    monkeypatch.setattr(hamilton_jacobi, "size_domain", lambda *_: box)
    short, long = (
        run(rate, horizon, rest=rest, frame=frame.value).arrays["margin_unrestricted"]
        for horizon in (6.0, 12.0)
    )
    end = run(rate, 12.0, rest=rest, kind=SetKind.FIXED, frame=frame.value)
    at_end = end.arrays["margin_unrestricted"]
    assert (long >= short - 1e-3).all()
    assert (long >= at_end - 1e-3).all()
    assert (long > short + 0.1).any()


def _overlap(a: np.ndarray, b: np.ndarray, where: np.ndarray) -> float:
    return float((a & b & where).sum() / (a | b)[where].sum())


def test_frames_agree_where_nothing_turns() -> None:
    for kind in SetKind:
        body, lvlh = (run(0.0, 12.0, kind=kind, frame=frame.value) for frame in Frame)
        gap = np.abs(body.arrays["margin_unrestricted"] - lvlh.arrays["margin_unrestricted"]).max()
        assert gap < 0.05


def test_auto_is_lvlh_but_for_corotating_tubes() -> None:
    for rest in Rest:
        for kind in SetKind:
            frame = "body" if (rest, kind) == (Rest.BODY, SetKind.TUBE) else "lvlh"
            detail = run(horizon=2.0, rest=rest, kind=kind).detail
            assert detail["frame"] == frame
            assert ("nothing dropped" in detail["model"]) is (frame == "lvlh")


def against_exact(
    rate: float, kind: SetKind, rest: Rest = Rest.LVLH, accuracy: Accuracy = "low", **options: Any
) -> tuple[float, int, EngineResult]:
    """IoU, exact cells and result: 41 x 41 x 15 x 15, 40 s; fixed-time sets in the corridor, tubes outside it."""
    problem = Problem(Scenario.of(rate, 0.1), rest=rest, kind=kind)
    asked = HamiltonJacobiInput(accuracy=accuracy, **options)
    result = HamiltonJacobi(asked).solve(problem, Context())
    assert result.code is ResultCode.OK, result.message
    exact = reach_margin(problem.scenario, problem.points(), 40.0, rest, kind) >= 0.0
    where = problem.inside() if kind is SetKind.FIXED else ~problem.inside()
    ours = result.arrays["margin_unrestricted"] >= 0.0
    return _overlap(ours, exact, where), int((exact & where).sum()), result


@pytest.mark.parametrize(("rate", "cells", "least"), [(1.0, 420, 0.98), (3.0, 237, 0.87), (5.0, 97, 0.65)])
def test_first_order_against_the_exact_fixed_time_set(rate: float, cells: int, least: float) -> None:
    overlap, exact, result = against_exact(rate, SetKind.FIXED)
    assert exact == cells
    assert overlap >= least
    # The scheme is what is left to complain of: velocity axes and box are fine at every rate.
    (warning,) = result.detail["warnings"]
    assert "take a higher accuracy" in warning


def test_a_sharper_scheme_repairs_most_of_it() -> None:
    assert HamiltonJacobiInput().accuracy == "very_high"
    overlap, _, result = against_exact(3.0, SetKind.FIXED, accuracy="very_high")
    assert overlap >= 0.97
    assert not result.detail["warnings"]


@pytest.mark.parametrize(("rate", "least"), [(1.0, 0.97), (3.0, 0.945), (5.0, 0.96)])
def test_first_order_against_the_exact_tube(rate: float, least: float) -> None:
    assert against_exact(rate, SetKind.TUBE)[0] >= least


@pytest.mark.parametrize(("kind", "rate", "least"), [(SetKind.FIXED, 1.0, 0.99), (SetKind.TUBE, 3.0, 0.83)])
def test_rest_in_the_body_against_the_exact_sets(kind: SetKind, rate: float, least: float) -> None:
    assert against_exact(rate, kind, Rest.BODY)[0] >= least


def test_the_frame_of_the_paper_says_where_it_fails() -> None:
    """At 3 deg/s its velocity axes hold 18 m/s, where thrust brings about 4: half of the set is lost."""
    overlap, _, result = against_exact(3.0, SetKind.FIXED, frame="body", nodes_xy=31)
    assert overlap < 0.6
    assert any("velocity spacing" in text for text in result.detail["warnings"])
    assert result.message


def test_every_result_carries_its_measured_error() -> None:
    """False-safe and false-unsafe cells by support functions; in the paper's frame at 5 deg/s most are wrong."""
    problem = Problem(Scenario.of(5.0, 0.1), rest=Rest.BODY)
    result = HamiltonJacobi(HamiltonJacobiInput(frame="body", accuracy="low")).solve(problem, Context())
    margin = reach_margin(problem.scenario, problem.points(), 40.0, Rest.BODY, SetKind.FIXED)
    np.testing.assert_allclose(result.arrays["margin_exact"], margin, atol=1e-9)
    ours = result.arrays["margin_unrestricted"] >= 0.0
    for name, where in (("grid", np.ones_like(ours)), ("in_corridor", problem.inside())):
        counted = result.detail["certified"][name]
        assert counted["false_safe"] == int((ours & (margin < -1e-6) & where).sum())
        assert counted["false_unsafe"] == int((~ours & (margin > 1e-6) & where).sum())
        assert counted["inner"] <= counted["outer"] <= counted["inner"] + 2
    assert result.detail["certified"]["in_corridor"]["false_safe"] > 50
    counted = HamiltonJacobi().solve(problem, Context()).detail["certified"]["in_corridor"]
    assert counted["false_safe"] <= 4


def test_a_velocity_aware_set_is_held_against_the_outer_bound_only() -> None:
    counted = run(match=0.5, kind=SetKind.FIXED).detail["certified"]["grid"]
    assert counted["inner"] is None
    assert counted["false_unsafe"] is None
    assert counted["false_safe"] == 0


def test_in_double_precision_the_answer_is_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    single = run(accuracy="high")
    monkeypatch.setattr(fused, "PRECISION", "float64")
    double = run(accuracy="high")
    gap = single.arrays["margin_unrestricted"] - double.arrays["margin_unrestricted"]
    assert 0.0 < np.abs(gap).max() < 1e-3


def test_a_poisoned_boundary_is_a_numerical_failure(monkeypatch: pytest.MonkeyPatch) -> None:
    """The library's own boundary condition lets inflow run away; ours, on the same grid, does not."""
    grid = Grid(11, 11, 150.0)
    assert run(horizon=40.0, grid=grid, frame="body").code is ResultCode.OK
    monkeypatch.setattr(fused, "BOUNDARY", "extrapolate_away_from_zero")
    result = run(horizon=40.0, grid=grid, frame="body")
    assert result.code is ResultCode.NUMERICAL_FAILURE
    assert result.mask is None
    assert result.margin is None
    assert "poisoned" in result.message


def test_a_value_that_is_not_finite_is_a_numerical_failure(monkeypatch: pytest.MonkeyPatch) -> None:
    whole = TargetValues.of

    def torn(*arguments: Any) -> TargetValues:
        values = whole(*arguments)
        terminal = np.array(values.terminal)
        terminal[3, 3, 3, 3] = np.nan
        return replace(values, terminal=terminal)

    monkeypatch.setattr(TargetValues, "of", torn)
    result = run()
    assert result.code is ResultCode.NUMERICAL_FAILURE
    assert result.mask is None
    assert "not finite" in result.message


def test_dismissal_stops_between_stretches() -> None:
    seen: list[float] = []
    context = Context(lambda done, _total, _message: seen.append(done), lambda: len(seen) >= 5)
    with pytest.raises(Cancelled):
        run(horizon=20.0, context=context)
    assert len(seen) == 5
    assert 0.0 < seen[-1] < 20.0


def test_one_compilation_serves_every_operating_point() -> None:
    run(3.0, solver="hj_reachability")
    known = list(peer._programs)
    run(1.0, horizon=14.0, grid=Grid(9, 9, 30.0), solver="hj_reachability")
    assert list(peer._programs) == known


def test_a_fixed_time_set_is_one_program_in_both_frames() -> None:
    run(3.0, kind=SetKind.FIXED, solver="hj_reachability")
    known = list(peer._programs)
    run(3.0, kind=SetKind.FIXED, frame="body", solver="hj_reachability")
    assert list(peer._programs) == known


def test_the_higher_schemes_run() -> None:
    for accuracy in ("medium", "high"):
        result = run(2.0, horizon=4.0, accuracy=accuracy, nodes_xy=11, nodes_v=7, kind=SetKind.FIXED)
        assert result.code is ResultCode.OK, result.message
        assert result.detail["accuracy"] == accuracy


@pytest.mark.parametrize(
    "options",
    [
        {"accuracy": "extreme"},
        {"accuracy": None},
        {"nodes_xy": 10},
        {"nodes_xy": 41.5},
        {"nodes_xy": "41x41"},
        {"nodes_v": 32},
        {"frame": "eci"},
        {"frame": "LVLH"},
        {"frame": ["lvlh"]},
        {"solver": "jax"},
        {"acuracy": "low"},
        {"boundary": "edge"},
    ],
)
def test_bad_options_are_refused(options: dict[str, Any]) -> None:
    (name,) = options
    inputs = {"omega_t_deg_s": 3, "a_max_m_s2": 0.1, "hamilton_jacobi": options}
    with pytest.raises(InvalidInput, match=f"^hamilton_jacobi.{name}: required"):
        process("benchmark").parse(inputs)
