"""C flight tables beside Python: verdicts on many starts, instructions per call.

``python -m benchmarks.flight_table starts 1000000`` and ``python -m benchmarks.flight_table instructions`` (valgrind).
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

import safestart as ss
from benchmarks.asked import parser
from safestart.flight_table.export import export, points_of
from safestart.flight_table.numbers import Point
from safestart.flight_table.vectors import GO, NO_GO, UNDECIDED, atlas_codes, certified_code, starts_of
from safestart.model.scenario import Floats

STRICT = ("-std=c99", "-Wall", "-Wextra", "-pedantic", "-Wconversion", "-Werror")
SANITIZED = ("-fsanitize=address,undefined", "-fno-sanitize-recover=all")
TYPES = {"float64": np.float64, "float32": np.float32}
RATES, THRUSTS = (0.0, 0.5, 1.0, 2.0, 3.0, 5.0), (0.02, 0.05, 0.1)
BLOCK = 100_000


def compiled(folder: Path, compiler: str = "gcc", options: tuple[str, ...] = ("-O2",)) -> Path:
    """The program of flight_table.c with the table in ``folder``."""
    program = folder / "ask"
    sources = [folder / "safestart_flight.c", folder / "safestart_table.c", Path(__file__).with_suffix(".c")]
    command = [compiler, *STRICT, *options, f"-I{folder}", *map(str, sources), "-lm", "-o", str(program)]
    subprocess.run(command, check=True)
    return program


def asked(program: Path, point: int, starts: Floats, precision: str) -> tuple[Floats, Floats]:
    """Verdicts and margins (S, 4): certified, atlas, in space, may start."""
    data = np.ascontiguousarray(starts, dtype=TYPES[precision]).tobytes()
    done = subprocess.run([str(program), str(point)], input=data, capture_output=True, check=True)
    found = np.frombuffer(done.stdout).reshape(len(starts), 4, 2)
    return found[..., 0], found[..., 1]


def checked(program: Path, point: int, starts: Floats, thrust: Floats, precision: str) -> Floats:
    """Margins (S,) of thrust histories (S, N, 2) from starts (S, 3), -1 where UNDECIDED."""
    rows = np.concatenate([starts, thrust.reshape(len(starts), -1)], axis=1).astype(TYPES[precision])
    command = [str(program), str(point), "thrust"]
    done = subprocess.run(command, input=rows.tobytes(), capture_output=True, check=True)
    return np.frombuffer(done.stdout)


def python_codes(point: Point, starts: Floats) -> Floats:
    """The same verdicts by safestart."""
    planar = [certified_code(point.planar, x, y) for x, y, _ in starts.tolist()]
    spatial = [certified_code(point.spatial, x, y, z) for x, y, z in starts.tolist()]
    atlas = atlas_codes(point, starts[:, :2])
    both = [GO if one == GO else other for one, other in zip(planar, atlas, strict=True)]
    return np.stack([planar, atlas, spatial, both], axis=-1).astype(np.float64)


def array_codes(point: Point, starts: Floats) -> Floats:
    """The same by safestart's calls on arrays."""
    codes = {"UNDECIDED": UNDECIDED, "GO": GO, "NO_GO": NO_GO}
    numbers = np.vectorize(codes.__getitem__)
    planar = numbers(ss.certify(point.scenario, starts[:, :2]).verdict)
    spatial = numbers(ss.certify(point.scenario, starts).verdict)
    atlas = np.array(atlas_codes(point, starts[:, :2]))
    return np.stack([planar, atlas, spatial, np.where(planar == GO, GO, atlas)], axis=-1).astype(np.float64)


def compare(total: int) -> int:
    """Differences over ``total`` starts, spread over a grid of operating points; exit code 1 where one is unsafe."""
    scenarios = [ss.Scenario.of(rate, thrust) for rate in RATES for thrust in THRUSTS]
    points = points_of(scenarios, 30, 2.0, 150.0)
    each, unsafe = -(-total // len(points)), 0
    for precision in TYPES:
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            export(points, precision).write(folder)
            program = compiled(folder)
            differ, claimed, said = np.zeros(4, int), np.zeros(4, int), np.zeros(4, int)
            for k, point in enumerate(points):
                for first in range(0, each, BLOCK):
                    starts = starts_of(point, min(BLOCK, each - first), 10_000 * k + first)
                    got, wanted = asked(program, k, starts, precision)[0], array_codes(point, starts)
                    differ += (got != wanted).sum(axis=0)
                    claimed += ((got != wanted) & (got != UNDECIDED)).sum(axis=0)
                    said += (wanted == GO).sum(axis=0)
        unsafe += int(claimed.sum())
        print(f"{precision}: {each * len(points)} starts; of certify, atlas, in space, may start:")
        print(
            f"  GO {said.tolist()}, different {differ.tolist()}, claimed what Python does not {claimed.tolist()}"
        )
    return int(unsafe > 0)


def instructions() -> None:
    """Instructions per call by callgrind, mean over starts of one operating point."""
    point = points_of([ss.Scenario.of(3.0, 0.1)], 30, 2.0, 150.0)
    starts = starts_of(point[0], 2_000, 1)
    names = ("ss_certify", "ss_atlas", "ss_certify_in_space", "ss_may_start")
    for precision in TYPES:
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            made = export(point, precision)
            made.write(folder)
            program = compiled(folder, options=("-O2", "-g", "-fno-inline-functions"))
            thrust = np.broadcast_to(point[0].atlas.centre.thrust, (50, 30, 2)) * 0.999
            centre = np.broadcast_to([*point[0].atlas.centre.start, 0.0], (50, 3))
            counts = {one: _counted(program, ["0"], starts, one, precision) / len(starts) for one in names}
            rows = np.concatenate([centre, thrust.reshape(50, -1)], axis=1)
            counts["ss_check_thrust"] = (
                _counted(program, ["0", "thrust"], rows, "ss_check_thrust", precision) / 50
            )
            size = sum(len(made.files[one]) for one in made.files)
            print(precision, {one: round(value) for one, value in counts.items()}, f"{size} bytes of files")


def _counted(program: Path, arguments: list[str], rows: Floats, function: str, precision: str) -> int:
    out = program.parent / "callgrind.out"
    command = ["valgrind", "--tool=callgrind", f"--callgrind-out-file={out}", f"--toggle-collect={function}"]
    data = np.ascontiguousarray(rows, dtype=TYPES[precision]).tobytes()
    subprocess.run([*command, str(program), *arguments], input=data, capture_output=True, check=True)
    line = next(line for line in out.read_text().splitlines() if line.startswith(("summary:", "totals:")))
    return int(line.split()[1])


if __name__ == "__main__":
    asked = parser(__doc__)
    studies = asked.add_subparsers(dest="study", required=True)
    studies.add_parser("starts").add_argument("count", type=int)
    studies.add_parser("instructions")
    given = asked.parse_args()
    if given.study == "starts":
        sys.exit(compare(given.count))
    instructions()
