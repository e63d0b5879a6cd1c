"""The command line as a user runs it: real processes, JSON alone on stdout; further questions in this process."""

import io
import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

from safestart.cli import build, main
from safestart.errors import InvalidInput

POINT = ["--omega-t-deg-s", "3", "--a-max-m-s2", "0.1"]


def safestart(*arguments: str, stdin: str = "") -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "safestart", *arguments]
    return subprocess.run(command, input=stdin, capture_output=True, text=True, check=False)


def document(*arguments: str, stdin: str = "") -> Any:
    done = safestart(*arguments, stdin=stdin)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def printed(*arguments: str) -> str:
    """The standard output of a command in this process: starting another takes seconds."""
    done = CliRunner().invoke(build(), arguments)
    assert done.exit_code == 0, done.stderr
    return done.stdout


def test_go_no_go_json() -> None:
    answer = document("go-no-go", *POINT, "--x-m", "5", "--y-m", "40", "--json")
    assert answer["verdict"] == "GO"
    assert answer["r_sync_m"] == pytest.approx(72.951, abs=1e-3)
    assert set(answer["face_margins_m"]) == {"hold_plane", "right", "left"}


def test_go_no_go_for_people() -> None:
    done = safestart("go-no-go", *POINT, "--x-m", "500", "--y-m", "40")
    assert done.returncode == 0
    assert "NO_GO" in done.stdout
    assert "right" in done.stdout


def test_no_tumble_is_null_with_a_reason() -> None:
    still = ["--omega-t-deg-s", "0", "--a-max-m-s2", "0.1", "--x-m", "0", "--y-m", "100"]
    answer = json.loads(printed("go-no-go", *still, "--json"))
    assert answer["verdict"] == "GO"
    assert answer["r_sync_m"] is None
    assert "does not tumble" in answer["r_sync_reason"]


@pytest.mark.parametrize(
    ("arguments", "named"),
    [
        (
            ["go-no-go", "--omega-t-deg-s", "-3", "--a-max-m-s2", "0.1", "--x-m", "5", "--y-m", "40"],
            "omega_t_deg_s",
        ),
        (
            ["go-no-go", "--omega-t-deg-s", "3", "--a-max-m-s2", "nan", "--x-m", "5", "--y-m", "40"],
            "a_max_m_s2",
        ),
        (["run", "no-such-process"], "benchmark"),
        (["run", "benchmark", "--input", "/no/such/file.json"], "--input"),
        (["run", "benchmark"], "omega_t_deg_s"),
    ],
)
def test_bad_input_is_named_in_one_line(
    arguments: list[str], named: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert named in refusal(arguments, "", monkeypatch, capsys)


@pytest.mark.parametrize(
    ("command", "twice"),
    [
        (["go-no-go", *POINT, "--x-m", "5", "--y-m", "40", "--omega-t-deg-s", "4"], "--omega-t-deg-s"),
        (["keys", "create", "--name", "a", "--name", "b"], "--name"),
    ],
)
def test_an_option_that_is_given_twice(command: list[str], twice: str) -> None:
    """The last one would win silently: at 3 deg/s it is GO, at 4 NO_GO."""
    with pytest.raises(InvalidInput, match=f"{twice}: required one value"):
        build()(command)


def test_what_may_be_given_twice() -> None:
    assert json.loads(printed("go-no-go", *POINT, "--x-m", "5", "--y-m", "40", "--json", "--json"))
    assert "Undefined" not in printed("go-no-go", "--help")


def test_bad_input_ends_the_process_with_code_two() -> None:
    done = safestart("run", "certificate", "--input", "-", stdin="not json")
    assert done.returncode == 2
    assert done.stdout == ""
    assert len(done.stderr.splitlines()) == 1


def refusal(
    arguments: list[str], stdin: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> str:
    """The one line that the command line ends with, in this process."""
    monkeypatch.setattr(sys, "argv", ["safestart", *arguments])
    monkeypatch.setattr(sys, "stdin", io.StringIO(stdin))
    with pytest.raises(SystemExit) as ended:
        main()
    assert ended.value.code == 2
    said = capsys.readouterr()
    assert said.out == ""
    assert len(said.err.splitlines()) == 1
    return said.err


@pytest.mark.parametrize("text", ["[1, 2", '{"omega_t_deg_s": NaN, "a_max_m_s2": 0.1}', "[]"])
def test_bad_input_documents(
    text: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    refusal(["run", "certificate", "--input", "-"], text, monkeypatch, capsys)


def test_run_writes_document_picture_and_arrays(tmp_path: Path) -> None:
    inputs = tmp_path / "in.json"
    inputs.write_text(
        json.dumps({"omega_t_deg_s": [1, 3], "a_max_m_s2": [0.1], "grid": {"nx": 41, "ny": 41}})
    )
    output = tmp_path / "coverage.json"
    assert printed("run", "coverage", "--input", str(inputs), "--output", str(output)) == ""
    written = json.loads(output.read_text())
    assert set(written) >= {"inputs", "outputs", "provenance"}
    assert written["inputs"]["corridor"]["c_x"] == 1.5
    assert len(written["outputs"]["cells"]) == 2
    assert output.with_name("coverage.coverage.png").read_bytes().startswith(b"\x89PNG")
    with np.load(output.with_name("coverage.masks.npz")) as arrays:
        assert arrays["mask"].shape == (2, 1, 41, 41)


def test_run_reads_stdin_and_prints_json() -> None:
    answer = document(
        "run", "certificate", "--input", "-", "--json", stdin='{"omega_t_deg_s": 3, "a_max_m_s2": 0.1}'
    )
    assert np.array(answer["outputs"]["mask"]).shape == (31, 31)
    assert answer["provenance"]["packages"]["safestart"]


def test_reproduce_table1() -> None:
    cells = json.loads(printed("reproduce", "table1", "--json"))["cells"]
    assert len(cells) == 20
    assert all(abs(cell["ours"] - cell["paper"]) <= 0.3 for cell in cells)


def test_reproduce_chain() -> None:
    shown = printed("reproduce", "chain", "--rate", "5", "--no-level-sets")
    assert "tube in analytical" in shown
    assert "analytical in synchronize" in shown
    assert "Violation fractions at 5 deg/s" in shown


def test_go_no_go_starts_without_the_engines() -> None:
    code = (
        "import sys; from safestart.cli import build; build(); from safestart.processes.execute import execute;"
        "execute('go-no-go', {'omega_t_deg_s': 3, 'a_max_m_s2': .1, 'states': [{'x_m': 0, 'y_m': 9}]});"
        "print(sorted({'jax', 'numba', 'scipy', 'matplotlib', 'distributed', 'fastapi'} & set(sys.modules)))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_reproduce_passive_safety() -> None:
    answer = json.loads(printed("reproduce", "passive-safety", "--json"))
    rows = answer["rows"]
    assert len(rows) == 22
    for row in rows:
        expected = "UNSAFE" if row["case"].startswith("SRU") and row["half_width_m"] == 0.2 else "SAFE"
        assert row["separation"] == expected
        assert (row["counter_example"] is None) == (expected == "SAFE")
        assert [row["thrust"], row["los"], row["velocity"]] == ["SAFE"] * 3
        assert row["published"]["verdict"] in ("SAFE", "UNSAFE")
    assert answer["paper"]["separation"] == "SAFE"
    assert answer["paper"]["published"]["tools_s"]["SDVTool"]["all"] == 5.5
