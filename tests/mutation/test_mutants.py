"""The mutants themselves: what is changed, that it takes effect in the function, and what is left alone."""

from __future__ import annotations

import builtins
import importlib.util
from pathlib import Path
from types import ModuleType

import pytest

from tests.mutation.mutants import mutants, probed

SOURCE = '''
def clamp(value: float, most: float = 3) -> float:
    """At most ``most``."""
    if value < 0:
        raise ValueError(f"required at least {0}")
    pairs = zip([value], [most], strict=True)
    return value if value <= most and pairs else most


class Box:
    def room(self, wide):
        return wide - 2


@compiled
def kernel(x):
    return x + 1
'''


@pytest.fixture
def module(tmp_path: Path) -> ModuleType:
    path = tmp_path / "sample.py"
    path.write_text(SOURCE.replace("@compiled", "compiled = lambda f: f\n\n\n@compiled"))
    spec = importlib.util.spec_from_file_location("sample", path)
    assert spec is not None
    assert spec.loader is not None
    made = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(made)
    return made


def test_each_change_is_one_of_the_code_and_no_text(module: ModuleType) -> None:
    found = [(one.name, one.change) for one in mutants(Path(module.__file__ or ""), "sample.py")]
    assert sorted(found) == [
        ("Box.room", "2 -> 3"),
        ("Box.room", "None for wide - 2"),
        ("Box.room", "Sub -> Add in wide - 2"),
        ("clamp", "0 -> 1"),
        ("clamp", "And -> Or in value <= most and pairs"),
        ("clamp", "Lt -> LtE in value < 0"),
        ("clamp", "LtE -> Lt in value <= most"),
        ("clamp", "None for value if value <= most and pairs else most"),
        ("clamp", "no raise"),
    ]


def test_a_mutant_runs_in_the_place_of_the_function(module: ModuleType) -> None:
    room = module.Box().room
    assert room(5) == 3
    (mutant,) = (one for one in mutants(Path(module.__file__ or ""), "") if one.change.startswith("Sub"))
    code = mutant.code()
    assert code is not None
    module.Box.room.__code__ = code
    assert room(5) == 7, "whoever holds the function runs the mutant"


def test_a_probe_tells_which_functions_run(module: ModuleType, monkeypatch: pytest.MonkeyPatch) -> None:
    told: list[str] = []
    monkeypatch.setattr(builtins, "reached", lambda _, name: told.append(name), raising=False)
    codes = dict(probed(Path(module.__file__ or "")))
    assert sorted(codes) == ["Box.room", "clamp"]
    module.clamp.__code__ = codes["clamp"]
    assert module.clamp(5.0) == 3
    assert told == ["clamp"]
