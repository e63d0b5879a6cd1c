"""Flight tables: compiled with every warning an error and sanitizers on, they say what Python says, and never more."""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import safestart as ss
from benchmarks.flight_table import STRICT, array_codes, asked, checked, compiled, python_codes
from safestart.attitude.body_frame import lvlh_to_body
from safestart.cli import main
from safestart.constraints.corridor import corridor_of
from safestart.dynamics.cwh import Cwh
from safestart.errors import InvalidInput
from safestart.exact.watch import watch_of
from safestart.flight_table import export as table
from safestart.flight_table.literals import PRECISIONS
from safestart.flight_table.numbers import Point, point_of
from safestart.flight_table.vectors import GO, NO_GO, UNDECIDED, starts_of
from safestart.model.scenario import Floats
from safestart.optim.prediction import prediction_of
from safestart.proofs.strict import ProofRejected

COMPILERS = ("gcc", "clang")
SANITIZED = ("-O1", "-fsanitize=address,undefined", "-fno-sanitize-recover=all")
SCENARIOS = [
    ss.Scenario.of(0.0, 0.05),
    ss.Scenario.of(3.0, 0.1),
    ss.Scenario(ss.Target(0.03, 0.0), ss.Chaser(0.02), ss.Corridor(0.8, 2.0, 1.0, 3.0, 2.0)),
]
STARTS = 1_500


def compiler_or_skip(name: str) -> str:
    if shutil.which(name) is None:
        pytest.skip(f"no {name} on this machine")
    return name


@pytest.fixture(scope="module")
def points() -> list[Point]:
    return table.points_of(SCENARIOS, 30, 2.0, 150.0)


@pytest.fixture(scope="module", params=["float64", "float32"])
def folder(request, points, tmp_path_factory) -> Path:
    place: Path = tmp_path_factory.mktemp(request.param)
    table.export(points, request.param).write(place)
    return place


def precision_of(folder: Path) -> str:
    return str(json.loads((folder / "manifest.json").read_text())["precision"])


def edges(point: Point, seed: int) -> Floats:
    """Starts where a wrong GO is likeliest: on the atlas's edges and rays, on faces, at the reach of members."""
    rng = np.random.default_rng(seed)
    rim = np.array([witness.start for witness in point.atlas.rim])
    centre = point.atlas.centre.start
    share = rng.uniform(size=(len(rim), 1))
    found = [rim, share * rim + (1 - share) * np.roll(rim, 1, axis=0), centre + share * (rim - centre)]
    rates = point.planar.rates
    if rates.scale > 0.0:
        radius = np.array([*point.planar.reach, rates.brake_limit]) / rates.scale
        angle = rng.uniform(0.6, 2.5, len(radius))
        found.append(np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=-1))
    for _, offset, a, b, _ in point.planar.faces:
        along = rng.uniform(-60.0, 60.0, 20)
        found.append(np.stack([a * offset - b * along, b * offset + a * along], axis=-1))
    planar = np.concatenate(found)
    planar = np.concatenate([planar + step for step in (0.0, 1e-9, -1e-9, 1e-6, -1e-6)])
    high = rng.choice([0.0, 1e-12, 2.5, -7.0], len(planar))
    return np.column_stack([planar, high]).astype(np.float32).astype(np.float64)


def sampled(point: Point, states: Floats, history: Floats) -> Floats:
    """The least distance of each flight to a face at a hundred times an interval."""
    question = point.atlas.question
    target, corridor = question.scenario.target, corridor_of(question.scenario.corridor)
    prediction = prediction_of(Cwh(target.mean_motion), question.dt, question.steps, 2, 100)
    times = question.dt * (np.arange(question.steps)[:, None] + np.linspace(0.0, 1.0, 101))
    least = []
    for state, one in zip(states, history, strict=True):
        flown = prediction.flight(state, one)
        body, _ = lvlh_to_body(flown[..., :2], flown[..., 2:], target.tumble_rate, times)
        least.append(float((corridor.slack(body) / corridor.lengths).min()))
    return np.array(least) + 1e-11


@pytest.mark.parametrize("compiler", COMPILERS)
def test_it_compiles_without_a_warning_and_its_vectors_pass(folder, compiler, tmp_path):
    sources = sorted(folder.glob("*.c"))
    program = tmp_path / "selftest"
    command = [compiler_or_skip(compiler), *STRICT, *SANITIZED, *map(str, sources), "-lm", "-o", str(program)]
    subprocess.run(command, check=True, capture_output=True)
    done = subprocess.run([str(program)], check=True, capture_output=True, text=True)
    manifest = json.loads((folder / "manifest.json").read_text())
    assert manifest["files"]["safestart_table.c"] in done.stdout
    assert f"{manifest['table_bytes']} bytes" in done.stdout
    assert "600 vectors, 0 wrong" in done.stdout


@pytest.mark.slow
@pytest.mark.parametrize("compiler", COMPILERS)
def test_valgrind_finds_nothing(folder, compiler, tmp_path):
    """Neither an invalid access nor a value that nobody has set, and no allocation at all."""
    if shutil.which("valgrind") is None:
        pytest.skip("no valgrind on this machine")
    program = tmp_path / "selftest"
    sources = map(str, sorted(folder.glob("*.c")))
    # Version 4: valgrind before 3.20 cannot read what clang writes of version 5.
    build = [compiler_or_skip(compiler), *STRICT, "-O1", "-gdwarf-4", *sources, "-lm", "-o", str(program)]
    subprocess.run(build, check=True, capture_output=True)
    watch = ["valgrind", "--tool=memcheck", "--error-exitcode=9", "--leak-check=full", "--track-origins=yes"]
    done = subprocess.run([*watch, str(program)], check=False, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert "ERROR SUMMARY: 0 errors" in done.stderr
    assert "600 vectors, 0 wrong" in done.stdout
    # The C library allocates one buffer for the standard output.
    assert "in use at exit: 0 bytes in 0 blocks" in done.stderr
    assert "total heap usage: 1 allocs, 1 frees" in done.stderr


@pytest.mark.parametrize("compiler", COMPILERS)
@pytest.mark.parametrize("options", [SANITIZED, ("-O3", "-march=native", "-ffp-contract=fast")])
def test_verdicts_are_pythons(folder, points, compiler, options):
    program = compiled(folder, compiler_or_skip(compiler), options)
    for k, point in enumerate(points):
        starts = starts_of(point, STARTS, 100 + k)
        got, margin = asked(program, k, starts, precision_of(folder))
        wanted = python_codes(point, starts)
        assert np.array_equal(wanted, array_codes(point, starts))
        assert not ((got != wanted) & (got != UNDECIDED)).any()
        # Where rounding matters float32 may hold back; double precision differs nowhere.
        assert (got != wanted).sum() <= (2 if precision_of(folder) == "float32" else 0)
        assert {UNDECIDED, GO, NO_GO} <= set(got.ravel())
        sure = ss.certify(point.scenario, starts[:, :2])
        go = got[:, 0] == GO
        assert (margin[go, 0] <= sure.margin_m[go]).all()
        assert (margin[go, 0] >= sure.margin_m[go] - 0.01).all()
        starts = edges(point, k)
        got, _ = asked(program, k, starts, precision_of(folder))
        assert not ((got != python_codes(point, starts)) & (got != UNDECIDED)).any()


def test_what_is_no_start_is_undecided(folder):
    program = compiled(folder, compiler_or_skip("gcc"), SANITIZED)
    starts = np.array(
        [[np.nan, 1, 0], [1, np.nan, 0], [1, 1, np.nan], [np.inf, 40, 0], [0, -np.inf, 0], [1e30, 1e30, 1]]
    )
    got, margin = asked(program, 1, starts, precision_of(folder))
    assert (got[[0, 1, 3, 4, 5]] == UNDECIDED).all()
    assert got[2, 2] == UNDECIDED
    assert (margin[got == UNDECIDED] == 0.0).all()


NOWHERE = """
#include "safestart_flight.h"

int main(void)
{
    static const ss_real thrust[2 * SS_STEPS];
    const int outside[] = {-1, SS_POINTS, SS_POINTS + 7};
    for (int i = 0; i < 3; i++) {
        const ss_point *point = ss_point_of(outside[i]);
        const ss_answer all[] = {
            ss_certify(point, 0, 40), ss_certify_in_space(point, 0, 40, 0), ss_atlas(point, 0, 40),
            ss_may_start(point, 0, 40), ss_check_thrust(point, 0, 40, thrust),
            ss_check_thrust(ss_point_of(0), 0, 40, 0),
        };
        for (int k = 0; k < 6; k++) {
            if (all[k].verdict != SS_UNDECIDED || all[k].margin != 0) {
                return 1 + k;
            }
        }
    }
    return 0;
}
"""


def test_a_point_that_is_not_in_the_table_is_undecided(folder, tmp_path):
    """It ended the flight computer's task."""
    (tmp_path / "nowhere.c").write_text(NOWHERE)
    sources = [folder / "safestart_flight.c", folder / "safestart_table.c", tmp_path / "nowhere.c"]
    compiler = compiler_or_skip("gcc")
    subprocess.run(
        [compiler, *SANITIZED, "-I", str(folder), *map(str, sources), "-lm", "-o", str(tmp_path / "nowhere")],
        check=True,
    )
    assert subprocess.run([tmp_path / "nowhere"], check=False).returncode == 0


def test_thrust_is_checked_as_in_the_proofs(folder, points):
    program = compiled(folder, compiler_or_skip("gcc"), SANITIZED)
    precision = precision_of(folder)
    for k, point in enumerate(points):
        watch, a_max = watch_of(point.atlas.question), point.scenario.chaser.max_acceleration
        some = (point.atlas.centre, point.atlas.deepest, *point.atlas.rim[:6])
        starts = np.array([[*witness.start, 0.0] for witness in some]).astype(np.float32).astype(np.float64)
        thrust = np.array([witness.thrust * (1.0 - 1e-6) for witness in some])
        rng = np.random.default_rng(k)
        noise = thrust + rng.normal(scale=0.2 * a_max, size=thrust.shape)
        size = np.linalg.norm(noise, axis=-1, keepdims=True)
        noise *= np.minimum(1.0, (1.0 - 1e-6) * a_max / size)
        for history in (thrust, noise):
            history = history.astype(np.float32).astype(np.float64)
            margin = checked(program, k, starts, history, precision)
            at_rest = np.column_stack([starts[:, :2], np.zeros((len(starts), 2))])
            true = np.array(
                [watch.minima(state, one).lowest for state, one in zip(at_rest, history, strict=True)]
            )
            # The bound of safestart stands 1e-7 m back; a hundred samples an interval bound the truth from above.
            assert (margin <= np.maximum(true + 1e-7, -1.0)).all()
            assert (margin <= np.maximum(sampled(point, at_rest, history), -1.0)).all()
            clear = true > (0.3 if precision == "float32" else 0.02)
            assert (margin[clear] >= true[clear] - (0.3 if precision == "float32" else 0.02)).all()
            assert clear.any()
        # A hair more thrust than there is.
        assert checked(program, k, starts[:1], np.full((1, 30, 2), a_max * 0.70711), precision)[0] == -1.0


def test_a_table_is_tied_to_its_proofs(folder, tmp_path):
    assert table.verify(folder) == json.loads((folder / "manifest.json").read_text())["proofs"] > 60
    copy = tmp_path / "copy"
    shutil.copytree(folder, copy)
    text = (copy / "safestart_table.c").read_text()
    (copy / "safestart_table.c").write_text(text.replace("0x1.9", "0x1.8", 1))
    with pytest.raises(InvalidInput, match=r"safestart_table\.c"):
        table.verify(copy)
    (copy / "safestart_table.c").write_text(text)
    proofs = json.loads((copy / "proofs.json").read_text())
    proofs[0]["margin_m"] += 1.0
    (copy / "proofs.json").write_text(json.dumps(proofs))
    manifest = json.loads((copy / "manifest.json").read_text())
    with pytest.raises(InvalidInput, match=r"proofs\.json"):
        table.verify(copy)
    from hashlib import sha256

    # Sealed anew, the header and then the checker refuse it.
    was, now = manifest["files"]["proofs.json"], sha256((copy / "proofs.json").read_bytes()).hexdigest()
    manifest["files"]["proofs.json"] = now
    (copy / "manifest.json").write_text(json.dumps(manifest))
    with pytest.raises(InvalidInput, match=r"safestart_table\.h"):
        table.verify(copy)
    header = (copy / "safestart_table.h").read_text().replace(was, now)
    (copy / "safestart_table.h").write_text(header)
    manifest["files"]["safestart_table.h"] = sha256(header.encode()).hexdigest()
    (copy / "manifest.json").write_text(json.dumps(manifest))
    with pytest.raises(ProofRejected):
        table.verify(copy)


def test_equal_questions_give_equal_tables(points):
    one, two = table.export(points[:1]), table.export(points[:1])
    assert one.files == two.files
    assert b"malloc" not in b"".join(one.files[name] for name in table.FIXED)


def test_literals_round_outward():
    rng = np.random.default_rng(3)
    single, double = PRECISIONS["float32"], PRECISIONS["float64"]
    for value in rng.normal(size=200) * 10.0 ** rng.integers(-9, 9, 200):
        low, high = (float.fromhex(single.down(value)[:-1]), float.fromhex(single.up(value)[:-1]))
        assert low <= value <= high
        assert high - low <= 1.3e-7 * abs(value)
        assert float.fromhex(double.near(value)) == value


def test_bad_input_is_refused_by_name(points):
    with pytest.raises(InvalidInput, match="operating points"):
        table.points_of([], 30, 2.0, 150.0)
    with pytest.raises(InvalidInput, match="float16"):
        table.export(points, "float16")
    with pytest.raises(InvalidInput, match="same scenario"):
        point_of(SCENARIOS[0], points[1].atlas)


def test_the_command_writes_and_checks(tmp_path, monkeypatch, capsys):
    def run(*arguments: str) -> int:
        monkeypatch.setattr(sys, "argv", ["safestart", "export-c", *arguments])
        with pytest.raises(SystemExit) as ended:
            main()
        return int(ended.value.code or 0)

    place = str(tmp_path / "table")
    asked_for = ("--omega-t-deg-s", "0", "--a-max-m-s2", "0.05,0.1", "--horizon-s", "20")
    assert run("--output", place, "--precision", "float32", *asked_for) == 0
    assert "2 operating points" in capsys.readouterr().out
    assert run("--output", place, "--check", "--json") == 0
    assert json.loads(capsys.readouterr().out)["proofs"] == table.verify(Path(place))
    for wrong in (
        ("--omega-t-deg-s", "x"),
        ("--omega-t-deg-s", "1,1"),
        ("--horizon-s", "3"),
        ("--precision", "f"),
    ):
        assert run("--output", place, *asked_for, *wrong) == 2
        assert wrong[0] in capsys.readouterr().err
    assert run("--output", str(tmp_path / "none"), "--check") == 2
