"""Commands that write files where they do not fit: one sentence, code 2, and what was there before."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

ASKED = ["--omega-t-deg-s", "3", "--a-max-m-s2", "0.1", "--x-m", "5", "--y-m", "40"]
PROVED = ["go-no-go", *ASKED, "--method", "exact", "--horizon-s", "600", "--proof"]
FLIGHT = {"omega_t_deg_s": 1, "a_max_m_s2": 0.1, "start": {"x_m": 2, "y_m": 40}, "horizon_s": 60}
MAP = {"omega_t_deg_s": 3, "a_max_m_s2": 0.1, "grid": {"nx": 31, "ny": 31, "y_max_m": 60}}
TIMELINE = [
    *("timeline", "--chaser", "f.chaser.oem", "--target", "f.target.oem", "--spin", "1"),
    "--a-max=0.1",
    "--output",
]
TABLE = ["export-c", "--omega-t-deg-s", "3", "--a-max-m-s2", "0.1", "--output"]


def command(folder: Path, *words: str, most_kib: int | None = None) -> subprocess.CompletedProcess[str]:
    """Run a command there whose files may have so many KiB each."""
    limit = "" if most_kib is None else f"ulimit -f {most_kib}; "
    asked = ["bash", "-c", f'{limit}exec "$@"', "bash", sys.executable, "-m", "safestart", *words]
    # Python 3.11 would keep modules that are cut off.
    environment = os.environ | {"PYTHONDONTWRITEBYTECODE": "1"}
    return subprocess.run(asked, cwd=folder, capture_output=True, text=True, env=environment)


@pytest.fixture(scope="module")
def flown(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a flight: its inputs, its document and its courses."""
    folder = tmp_path_factory.mktemp("flown")
    (folder / "start.json").write_text(json.dumps(FLIGHT))
    (folder / "asked.json").write_text(json.dumps(MAP))
    done = command(folder, "run", "flight", "--input", "start.json", "--output", "f.json")
    assert done.returncode == 0, done.stderr
    return folder


@pytest.mark.parametrize("most_kib", [0, 4, 8])
@pytest.mark.parametrize(
    "words",
    [
        ["run", "flight", "--input", "start.json", "--output", "place/f.json"],
        ["run", "certificate", "--input", "asked.json", "--output", "place/o.json"],
        ["convert", "f.chaser.oem", "place/q.xml"],
        [*PROVED, "place/p.json"],
        [*TIMELINE, "place/t.json"],
        [*TABLE, "place"],
    ],
    ids=lambda words: words[0] + words[1].replace("-", "_"),
)
@pytest.mark.parametrize("old", [False, True])
def test_nothing_is_half_there(flown: Path, words: list[str], most_kib: int, old: bool) -> None:
    place = flown / "place"
    place.mkdir()
    before = dict.fromkeys(("f.json", "o.json", "q.xml", "p.json", "f.chaser.oem") if old else (), "old")
    for name, text in before.items():
        (place / name).write_text(text)
    try:
        done = command(flown, *words, most_kib=most_kib)
        assert done.returncode == 2, done.stdout
        assert "File too large" in done.stderr
        assert "Traceback" not in done.stderr
        assert "wrote" not in done.stderr + done.stdout
        assert {one.name: one.read_text() for one in place.iterdir()} == before
    finally:
        for one in place.iterdir():
            one.unlink()
        place.rmdir()


def test_a_file_that_fits_is_there(flown: Path) -> None:
    done = command(flown, "convert", "f.chaser.oem", "q.csv", most_kib=1000)
    assert done.returncode == 0
    assert (flown / "q.csv").stat().st_size > 1000
