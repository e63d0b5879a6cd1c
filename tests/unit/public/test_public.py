"""`import safestart as ss`: what the calls return, what they refuse, how results show themselves."""

from __future__ import annotations

import builtins
import json
import math
import subprocess
import sys

import numpy as np
import pytest

import safestart as ss
from safestart.closed_form.certified_point import certify_point, prepare
from safestart.constraints.corridor import corridor_of
from safestart.errors import InvalidInput, NotFound, Unavailable
from safestart.proofs.strict import ProofRejected
from safestart.public.results import Result
from safestart.public.starts import degrees_of

POINT = ss.Scenario.of(3.0, 0.1)
START = (5.0, 40.0)


def test_an_import_loads_nothing_and_knows_its_names():
    heavy = [
        "numpy",
        "scipy",
        "numba",
        "matplotlib",
        "pandas",
        "clarabel",
        "flint",
        "pydantic",
        "typer",
        "httpx",
    ]
    code = f"import sys, safestart; print([name for name in {heavy} if name in sys.modules])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
    assert 12 <= len(ss.__all__) <= 15
    assert set(ss.__all__) <= set(dir(ss))
    for name in ss.__all__:
        assert getattr(ss, name) is not None
    with pytest.raises(AttributeError, match="nothing_of_ours"):
        _ = ss.nothing_of_ours


def test_the_service_client_alone_loads_no_kernels():
    code = "import sys, safestart as ss; ss.Client('http://127.0.0.1:1'); print('numba' in sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "False"


def test_certify_is_the_certificate_of_single_starts():
    rng = np.random.default_rng(5)
    points = rng.uniform([-120.0, -20.0], [120.0, 150.0], size=(30, 40, 2))
    found = ss.certify(POINT, points)
    assert found.verdict.shape == found.margin_m.shape == (30, 40)
    target = POINT.target
    given = prepare(target.tumble_rate, target.mean_motion, 0.1, POINT.corridor, ss.Rest.LVLH, False)
    alone = [certify_point(given, x, y) for x, y in points.reshape(-1, 2)]
    assert np.array_equal(found.go.ravel(), [one.go for one in alone])
    assert {"GO", "NO_GO", "UNDECIDED"} == set(found.verdict.ravel())
    go = found.go.ravel()
    assert found.margin_m.ravel()[go].tolist() == [one.margin for one in alone if one.go]
    assert np.isnan(found.margin_m[found.verdict == "UNDECIDED"]).all()
    assert (found.margin_m[found.verdict == "NO_GO"] < 0.0).all()
    # No start that the exact answer calls GO is called NO_GO here.
    some = points.reshape(-1, 2)[found.verdict.ravel() == "NO_GO"][:20]
    assert {ss.decide(POINT, start).verdict for start in some} == {"NO_GO"}


def test_the_manoeuvre_of_a_certified_start_stays_in_the_corridor():
    found = ss.certify(POINT, [[START, (0.0, 149.0)]], rest="body")
    assert found.verdict.tolist() == [["GO", "UNDECIDED"]]
    plan = found.manoeuvre(0, 0)
    assert plan is not None
    assert found.manoeuvre(0, 1) is None
    times = np.linspace(0.0, 200.0, 2001)
    place, velocity, _ = plan.motion(times)
    np.testing.assert_allclose([place[0], velocity[0]], [[*START, 0.0], [0.0, 0.0, 0.0]], atol=1e-12)
    assert np.linalg.norm(plan.thrust_lvlh(times), axis=1).max() <= POINT.chaser.max_acceleration
    room = corridor_of(POINT.corridor, 3)
    assert (room.slack(place) / room.lengths).min() >= found.margin_m[0, 0] - 1e-9
    for index in ((0,), (0, 2), (0, 0, 0)):
        with pytest.raises(ss.SafestartError, match="index"):
            found.manoeuvre(*index)


def test_decide_is_proved_either_way():
    go, lost = ss.decide(POINT, START), ss.decide(POINT, (0.0, 149.0))
    assert (go.verdict, lost.verdict) == ("GO", "NO_GO")
    assert go.verify().margin_m > 0.0 > lost.verify().margin_m
    assert go.thrust_m_s2.shape == (30, 2)
    assert lost.thrust_m_s2.shape == (0, 2)
    assert np.linalg.norm(go.thrust_m_s2, axis=1).max() <= 0.1
    flown = go.to_dataframe()
    assert list(flown.columns) == ["time_s", "x_m", "y_m"]
    assert flown.time_s.iloc[-1] == 60.0
    assert tuple(flown[["x_m", "y_m"]].iloc[0]) == START
    space = ss.decide(POINT, (5.0, 40.0, 3.0), "body", question="synchronize", within_s=100.0)
    assert space.verify().verdict == space.verdict
    assert space.proof is not None
    assert space.proof["question"]["kind"] == "synchronize"


def test_a_hold_after_the_arrival_flies():
    asked = {"question": "synchronize", "within_s": 80.0}
    held = ss.decide(POINT, START, **asked, after_arrival="hold")
    assert held.go
    assert "keeps it for ever" in held.reason
    assert any("under a feedback" in line for line in held.verify().statement)
    flown = ss.fly(POINT, START, held.pilot(duration_s=400.0), horizon_s=400.0)
    assert flown.safe
    assert flown.closest_m > 0.1
    assert flown.body_m[-1] == pytest.approx(held.proof["hold_after"]["point_m"], abs=1e-6)
    for other in ("stay", "any"):
        found = ss.decide(POINT, START, **asked, after_arrival=other)
        assert "hold_after" not in found.proof
        with pytest.raises(InvalidInput, match="after_arrival hold"):
            found.pilot()
    with pytest.raises(InvalidInput, match="stay, hold or any"):
        ss.decide(POINT, START, **asked, after_arrival="leave")
    with pytest.raises(InvalidInput, match="planar"):
        ss.decide(POINT, (*START, 3.0), **asked, after_arrival="hold")


def test_verify_reads_files_and_refuses_forgeries(tmp_path):
    proof = ss.decide(POINT, START).proof
    assert proof is not None
    file = tmp_path / "proof.json"
    file.write_text(json.dumps(proof))
    assert ss.verify(file).margin_m == ss.verify(proof).margin_m == ss.verify(str(file)).margin_m
    with pytest.raises(ProofRejected, match="digest"):
        ss.verify({**proof, "margin_m": proof["margin_m"] + 1.0})
    file.write_text("{")
    with pytest.raises(InvalidInput, match="JSON"):
        ss.verify(file)
    with pytest.raises(InvalidInput, match="readable"):
        ss.verify(tmp_path / "none.json")


def test_region_agrees_with_decide():
    region = ss.region(POINT)
    assert 0.0 < region.inner_area_m2 < region.outer_area_m2 < 1.01 * region.inner_area_m2
    rng = np.random.default_rng(9)
    points = rng.uniform([-100.0, 0.5], [100.0, 150.0], size=(60, 2))
    words = region.verdicts(points)
    for start, word in zip(points, words, strict=True):
        if word != "UNDECIDED":
            assert ss.decide(POINT, start).verdict == word, start
    assert {"GO", "NO_GO"} <= set(words)
    assert region.verdicts([0.0, 151.0]) == "UNDECIDED"
    assert region.verdicts(region.inner_m[0]) == "UNDECIDED"
    with pytest.raises(InvalidInput, match="planar"):
        region.verdicts([[0.0, 40.0, 0.0]])
    assert set(region.to_dataframe().polygon) == {"inner", "outer"}


def test_fly_without_and_with_controllers():
    best = ss.fly(POINT, START)
    assert best.verdict == "GO"
    assert best.closest_m == pytest.approx(ss.decide(POINT, START).margin_m, abs=1e-2)
    for name in ("filter", "sequence"):
        flown = ss.fly(POINT, START, name)
        assert flown.safe
        assert flown.time_s[-1] == 60.0
        assert flown.body_m.shape == flown.thrust_m_s2.shape == (31, 2)
        assert flown.distance_m.shape == (31, 3)
        assert flown.closest_m <= flown.distance_m.min() + 1e-9
    assert ss.fly(POINT, (5.0, 40.0, 2.0), "filter", motion="two_body_j2").body_m.shape == (31, 3)


def test_a_pilot_flies_in_another_simulator_as_in_ours():
    ours = ss.fly(POINT, START, "filter")
    pilot = ss.controller("filter", POINT)
    state = np.array([*START, 0.0, 0.0, 0.0, 0.0])
    pilot.begin(state)
    n, h = POINT.target.mean_motion, 0.01

    def rate(s, u):
        x, _, z, vx, vy, vz = s
        return np.array(
            [vx, vy, vz, 3 * n * n * x + 2 * n * vy + u[0], -2 * n * vx + u[1], -n * n * z + u[2]]
        )

    for k in range(pilot.steps):
        thrust = pilot.command(k, state).thrust
        for _ in range(round(pilot.dt_s / h)):
            a = rate(state, thrust)
            b = rate(state + 0.5 * h * a, thrust)
            c = rate(state + 0.5 * h * b, thrust)
            state = state + h / 6.0 * (a + 2 * b + 2 * c + rate(state + h * c, thrust))
    assert np.allclose(state[:2], ours.lvlh_m[-1], atol=1e-6)


def test_anybodys_controller_flies_and_gets_no_more_thrust_than_there_is():
    class Push:
        def command(self, k, state):
            return [0.0, -5.0, 0.0]

    flown = ss.fly(POINT, (0.0, 100.0), Push())
    assert np.linalg.norm(flown.thrust_m_s2, axis=1).max() == pytest.approx(0.1)
    assert not flown.safe

    class Broken:
        def command(self, k, state):
            return [0.0, math.nan, 0.0]

    with pytest.raises(InvalidInput, match="thrust"):
        ss.fly(POINT, START, Broken())


@pytest.mark.parametrize(
    ("call", "said"),
    [
        (lambda: ss.certify(POINT, [[1.0]]), "last axis"),
        (lambda: ss.certify(POINT, [["a", "b"]]), "numbers"),
        (lambda: ss.certify(POINT, [[math.nan, 1.0]]), "finite"),
        (lambda: ss.decide(POINT, [[5.0, 40.0]]), r"\(2,\) or \(3,\)"),
        (lambda: ss.decide(POINT, START, horizon_s=61.0), "multiple of 2 s"),
        (lambda: ss.decide(POINT, START, horizon_s=True), "multiple of 2 s"),
        (lambda: ss.decide(POINT, START, question="leave"), "stay or synchronize"),
        (lambda: ss.region(POINT, y_max_m=0.1), "y_max_m"),
        (lambda: ss.controller("nobody", POINT), "filter or sequence"),
        (lambda: ss.controller("sequence", POINT, spatial=True), "orbit plane"),
        (lambda: ss.controller("sequence", POINT).command(0, np.zeros(6)), "begin"),
        (lambda: ss.fly(POINT, START, ss.controller("filter", POINT, duration_s=20.0)), "30 intervals"),
        (lambda: ss.fly(POINT, START, "filter", question="synchronize"), "stay"),
        (lambda: ss.run("flight", {"omega_t_deg_s": 3}, progress=False), "a value"),
        (lambda: ss.Client("ftp://x"), "address"),
    ],
)
def test_bad_input_is_refused_by_name(call, said):
    with pytest.raises(InvalidInput, match=said):
        call()


def test_a_pilot_refuses_other_intervals_and_states():
    pilot = ss.controller("filter", POINT, duration_s=10.0)
    pilot.begin([5.0, 40.0, 0.0, 0.0, 0.0, 0.0])
    assert pilot.command(4, np.array([5.0, 40.0, 0.0, 0.0, 0.0, 0.0])).thrust.shape == (3,)
    for k in (5, -1, 0.5, True):
        with pytest.raises(InvalidInput, match="integer"):
            pilot.command(k, np.zeros(6))
    with pytest.raises(InvalidInput, match="shape"):
        pilot.command(0, np.zeros(4))


def test_run_gives_tables_and_files(tmp_path, capsys):
    inputs = {"omega_t_deg_s": 3, "a_max_m_s2": 0.1, "y_max_m": 60, "horizon_s": 20}
    result = ss.run("safe-region", inputs)
    assert "safe-region" in capsys.readouterr().err
    assert result.outputs["inner_area_m2"] == ss.region(POINT, horizon_s=20, y_max_m=60).inner_area_m2
    assert list(result.to_dataframe().columns) == ["inner_polygon_m.0", "inner_polygon_m.1"]
    assert len(result.to_dataframe("outer_polygon_m")) == len(result.outputs["outer_polygon_m"])
    with pytest.raises(InvalidInput, match="inner_polygon_m"):
        result.to_dataframe("cells")
    written = result.save(tmp_path / "out")
    assert json.loads(written[0].read_text()) == result.document
    assert "inner_area_m2" in result._repr_html_()
    with pytest.raises(NotFound, match="no process"):
        ss.run("nothing")


def test_results_show_themselves():
    shown = [
        ss.certify(POINT, [START, (0.0, 149.0)]),
        ss.decide(POINT, START),
        ss.decide(POINT, (0.0, 149.0)),
        ss.region(POINT),
        ss.fly(POINT, START),
    ]
    for result in shown:
        png = result._repr_png_()
        assert png is not None
        assert png.startswith(b"\x89PNG")
        html = result._repr_html_()
        assert "data:image/png;base64," in html
        assert len(result.to_dataframe()) >= 1
        axes = result.plot()
        assert axes.lines or axes.patches or axes.collections


def test_a_backend_that_a_notebook_chose_stays():
    code = (
        "import matplotlib; matplotlib.use('svg'); import safestart as ss;"
        "ss.region(ss.Scenario.of(3, 0.1))._repr_png_(); print(matplotlib.get_backend())"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "svg"


def test_without_matplotlib_and_pandas_facts_remain(monkeypatch):
    real = builtins.__import__

    def without(name, *args, **kwargs):
        if name.partition(".")[0] in ("matplotlib", "pandas"):
            raise ImportError(name)
        return real(name, *args, **kwargs)

    found = ss.certify(POINT, [START])
    monkeypatch.setattr(builtins, "__import__", without)
    assert found._repr_png_() is None
    assert "<img" not in found._repr_html_()
    with pytest.raises(Unavailable, match="matplotlib"):
        found.plot()
    with pytest.raises(Unavailable, match="pandas"):
        found.to_dataframe()


def test_degrees_come_back_to_the_bit_for_usual_rates():
    for tenths in range(601):
        rate = math.radians(tenths / 10.0)
        assert math.radians(degrees_of(rate)) == rate
        assert degrees_of(rate) == tenths / 10.0
    rng = np.random.default_rng(2)
    for rate in rng.uniform(0.0, 1.0, 1000):
        assert math.radians(degrees_of(float(rate))) == pytest.approx(rate, rel=3e-16)


def test_texts_of_a_result_are_escaped():
    result = Result("flight", {"outputs": {"message": "<script>alert(1)</script>"}}, ())
    assert "<script>" not in result._repr_html_()
    assert "&lt;script&gt;" in result._repr_html_()
    assert result.tables() == {}
