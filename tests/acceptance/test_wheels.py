"""Wheels built from the sources install into an empty environment and work without the checkout."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
SMOKE = Path(__file__).with_name("wheel_smoke.py")
VERSIONS = ("3.11", "3.12", "3.13")


def uv(*arguments: str, **options: object) -> subprocess.CompletedProcess[str]:
    program = shutil.which("uv")
    if program is None:
        pytest.skip("no uv on this machine")
    done = subprocess.run([program, *arguments], capture_output=True, text=True, check=False, **options)  # type: ignore[call-overload]
    assert done.returncode == 0, done.stderr
    return done  # type: ignore[no-any-return]


def interpreter(version: str) -> str | None:
    """An interpreter of that version which starts, on the path or among pyenv's."""
    root = Path(os.environ.get("PYENV_ROOT", Path.home() / ".pyenv"))
    found = [
        shutil.which(f"python{version}"),
        *sorted(root.glob(f"versions/{version}.*/bin/python{version}")),
    ]
    for one in filter(None, found):
        done = subprocess.run([str(one), "-c", "import venv"], capture_output=True, check=False)
        if done.returncode == 0:
            return str(one)
    return None


@pytest.fixture(scope="module")
def wheels(tmp_path_factory) -> list[str]:
    """The three wheels, each built from its sdist; the version in their names is the core's."""
    place = tmp_path_factory.mktemp("dist")
    uv("build", "--quiet", "--all-packages", "--out-dir", str(place), cwd=ROOT)
    line = next(
        line
        for line in (ROOT / "core/safestart/__init__.py").read_text().splitlines()
        if line.startswith("__version__")
    )
    version = line.split('"')[1]
    built = sorted(place.glob("*.whl"))
    assert [one.name.split("-")[:2] for one in built] == [
        [name, version] for name in ("safestart", "safestart_service", "safestart_worker")
    ]
    return [str(one) for one in built]


@pytest.mark.slow
@pytest.mark.parametrize("version", VERSIONS)
def test_wheels_install_and_work_without_the_checkout(version, wheels, tmp_path):
    python = interpreter(version)
    if python is None:
        pytest.skip(f"no Python {version} on this machine")
    uv("venv", "--quiet", "--python", python, str(tmp_path / "venv"))
    # The versions that are tested, where the project pins them.
    pins = tmp_path / "pins.txt"
    pinned = (ROOT / "pyproject.toml").read_text().split("# pins: begin")[1].split("# pins: end")[0]
    pins.write_text("\n".join(line.strip(' ",') for line in pinned.splitlines() if "==" in line))
    here = tmp_path / "venv/bin/python"
    uv("pip", "install", "--quiet", "--python", str(here), "--constraint", str(pins), *wheels)
    shutil.copy(SMOKE, tmp_path)
    clean = {
        name: value for name, value in os.environ.items() if not name.startswith(("PYTHON", "VIRTUAL_ENV"))
    }
    clean |= {"HOME": str(tmp_path), "NUMBA_CACHE_DIR": str(tmp_path / "numba")}

    def run(*command: str) -> str:
        done = subprocess.run(command, cwd=tmp_path, env=clean, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr
        return done.stdout

    assert f"smoke passed on {version}" in run(str(here), "-I", str(tmp_path / SMOKE.name))
    command = str(tmp_path / "venv/bin/safestart")
    asked = ("go-no-go", "--omega-t-deg-s", "3", "--a-max-m-s2", "0.1", "--x-m", "5", "--y-m", "40", "--json")
    assert json.loads(run(command, *asked))["verdict"] == "GO"
    help_text = run(command, "--help")
    assert all(name in help_text for name in ("serve", "worker", "export-c", "demo"))
