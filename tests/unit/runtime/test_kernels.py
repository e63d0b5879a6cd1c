"""Compiled kernels on disk: every dependency is part of the key, and no broken or missing cache stops the work."""

import ast
import gc
import importlib
import logging
import os
import pkgutil
import re
import runpy
import subprocess
import sys
from collections.abc import Iterator
from contextlib import redirect_stderr, redirect_stdout
from functools import cache
from multiprocessing import get_context
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest
from numba import config
from numba.core import event

import safestart
from safestart.runtime.kernels import compiled as kernels
from safestart.runtime.kernels import warmup
from safestart.runtime.kernels.compiled import KernelCache, compiled

NOT_IMPORTED = ("migrations", "__main__", "orphan_guard", ".cli")

# A kernel that takes a constant and a function from a module, and a record from another, as ours do.
TOY = {
    "safestart_toy/__init__.py": "",
    "safestart_toy/numbers.py": "FACTOR = 2.0\n",
    "safestart_toy/callee.py": (
        "from safestart.runtime.kernels.compiled import compiled\n@compiled()\ndef twice(x):\n    return 2.0 * x\n"
    ),
    "safestart_toy/record.py": (
        "from typing import NamedTuple\nclass Pair(NamedTuple):\n    first: float\n    second: float\n"
    ),
    "safestart_toy/kernel.py": (
        "from safestart.runtime.kernels.compiled import compiled\n"
        "from safestart_toy.callee import twice\nfrom safestart_toy.numbers import FACTOR\n"
        "@compiled()\ndef run(pair):\n    return FACTOR * twice(pair.first)\n"
    ),
    "run.py": (
        "import logging\nlogging.basicConfig()\n"
        "from safestart_toy.kernel import run\nfrom safestart_toy.record import Pair\n"
        "print(run(Pair(first=3.0, second=5.0)), sum(run.stats.cache_hits.values()))\n"
    ),
}


def modules() -> Iterator[ModuleType]:
    for entry in pkgutil.walk_packages(safestart.__path__, "safestart."):
        if not any(part in entry.name for part in NOT_IMPORTED):
            yield importlib.import_module(entry.name)


def lines_of(kernel: Any) -> set[str]:
    return set(kernels._frozen(kernel.py_func, set()))


def toy(folder: Path, **changed: str) -> tuple[float, int]:
    """The toy's result, and how many kernels came from the cache, in a new process that begins with our imports."""
    for name, text in (TOY | {f"safestart_toy/{key}.py": value for key, value in changed.items()}).items():
        path = folder / name
        path.parent.mkdir(exist_ok=True)
        if not path.exists() or path.read_text() != text:
            path.write_text(text)
    _prepared()
    said, log = folder / "said.txt", folder / "log.txt"
    process = get_context("fork").Process(target=_run, args=(folder, said, log))
    process.start()
    process.join()
    toy.log = log.read_text()  # type: ignore[attr-defined]
    assert process.exitcode == 0, toy.log  # type: ignore[attr-defined]
    value, hits = said.read_text().split()
    return float(value), int(hits)


@cache
def _prepared() -> None:
    """The first compilation of a process prepares Numba for a second; a forked one has that behind it."""
    compiled()(lambda x: 2.0 * x)(1.0)


def _run(folder: Path, said: Path, log: Path) -> None:
    sys.dont_write_bytecode = True
    sys.path.insert(0, str(folder))
    for handler in list(logging.root.handlers):
        logging.root.removeHandler(handler)
    with said.open("w") as out, log.open("w") as err, redirect_stdout(out), redirect_stderr(err):
        runpy.run_path(str(folder / "run.py"))


def started(folder: Path) -> tuple[float, int]:
    """The same in an interpreter of its own, with another order of sets."""
    done = subprocess.run(
        [sys.executable, str(folder / "run.py")],
        env=os.environ | {"PYTHONPATH": str(folder), "PYTHONDONTWRITEBYTECODE": "1"},
        capture_output=True,
        text=True,
        check=True,
    )
    value, hits = done.stdout.split()
    return float(value), int(hits)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("changed", "value"),
    [
        ({"numbers": "FACTOR = 10.0\n"}, 60.0),
        ({"callee": TOY["safestart_toy/callee.py"].replace("2.0 * x", "7.0 * x")}, 42.0),
        (
            {
                "record": TOY["safestart_toy/record.py"].replace(
                    "first: float\n    second", "second: float\n    first"
                )
            },
            12.0,
        ),
    ],
)
def test_a_changed_dependency_reaches_the_cache(
    tmp_path: Path, changed: dict[str, str], value: float
) -> None:
    """A constant, a callee, the order of a record's fields: each in a file of its own."""
    assert toy(tmp_path) == (12.0, 0)
    assert toy(tmp_path) == (12.0, 1)
    assert toy(tmp_path, **changed) == (value, 0)
    assert toy(tmp_path) == (12.0, 1)


@pytest.mark.slow
def test_an_interpreter_finds_what_another_has_compiled(tmp_path: Path) -> None:
    """Options that are sets, too: each interpreter goes through a set in another order."""
    fast = TOY["safestart_toy/callee.py"].replace(
        "@compiled()", "@compiled(fastmath={'nsz', 'contract', 'arcp'})"
    )
    assert toy(tmp_path, callee=fast) == (12.0, 0)
    assert started(tmp_path) == (12.0, 1)


# A kernel that takes an option, a callee's default and a module's constant from elsewhere.
INDIRECT = {
    "settings": "OPTION = 'python'\nDEFAULT = 2.0\nFACTOR = 2.0\n",
    "numbers": "from safestart_toy.settings import FACTOR\n",
    "callee": (
        "from safestart.runtime.kernels.compiled import compiled\nfrom safestart_toy.settings import DEFAULT\n"
        "@compiled()\ndef twice(x, by=DEFAULT):\n    return by * x\n"
    ),
    "kernel": (
        "from safestart.runtime.kernels.compiled import compiled\nimport safestart_toy.numbers as numbers\n"
        "from safestart_toy.callee import twice\nfrom safestart_toy.settings import OPTION\n"
        "@compiled(error_model=OPTION)\n"
        "def run(pair):\n    return numbers.FACTOR * twice(pair.first)\n"
    ),
}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "text", "value"),
    [("DEFAULT", "7.0", 42.0), ("FACTOR", "10.0", 60.0), ("OPTION", "'numpy'", 12.0)],
)
def test_what_a_kernel_takes_indirectly_reaches_the_cache(
    tmp_path: Path, name: str, text: str, value: float
) -> None:
    assert toy(tmp_path, **INDIRECT) == (12.0, 0)
    settings = re.sub(rf"{name} = .*", f"{name} = {text}", INDIRECT["settings"])
    assert toy(tmp_path, **INDIRECT | {"settings": settings}) == (value, 0)


def test_options_belong_to_the_key() -> None:
    """Of the kernel, and of those that it calls; in the same words in every process, whatever the order of a set."""
    callee = compiled(fastmath={"nsz", "contract"})(lambda x: x)
    kernel = compiled(fastmath=True)(lambda x: callee(x))
    if hasattr(kernel._cache, "options"):  # another kind where no folder can be written to
        assert "('fastmath', True)" in kernel._cache.options
    assert any("('fastmath', ['contract', 'nsz'])" in line for line in lines_of(kernel))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("suffix", "damage"),
    [(".nbi", "empty"), (".nbi", "truncated"), (".nbc", "truncated"), (".nbc", "altered")],
)
def test_a_damaged_cache_is_compiled_again(tmp_path: Path, suffix: str, damage: str) -> None:
    assert toy(tmp_path) == (12.0, 0)
    files = list(tmp_path.rglob(f"kernel.run*{suffix}"))
    assert files
    for file in files:
        content = file.read_bytes()
        middle = len(content) // 2
        altered = content[:middle] + bytes([content[middle] ^ 255]) + content[middle + 1 :]
        file.write_bytes({"empty": b"", "truncated": content[:middle], "altered": altered}[damage])
    assert toy(tmp_path) == (12.0, 0)
    assert "cannot be read and is compiled again" in toy.log  # type: ignore[attr-defined]
    assert toy(tmp_path) == (12.0, 1)


@pytest.mark.slow
def test_the_code_of_another_kernel_is_compiled_again(tmp_path: Path) -> None:
    """A restored folder or a file system may mix files up; each of them is whole."""
    places = tmp_path / "one", tmp_path / "other"
    for place in places:
        place.mkdir()
    assert toy(places[0]) == (12.0, 0)
    assert toy(places[1], numbers="FACTOR = 5.0\n") == (30.0, 0)
    own, other = (next(place.rglob("kernel.run*.nbc")) for place in places)
    own.write_bytes(other.read_bytes())
    assert toy(places[0]) == (12.0, 0)
    assert "cannot be read and is compiled again" in toy.log  # type: ignore[attr-defined]
    assert toy(places[0]) == (12.0, 1)


def test_no_place_for_a_cache_is_one_line(
    monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    def nowhere(self: KernelCache, function: Any) -> None:
        raise RuntimeError("cannot cache function: no locator available")

    monkeypatch.setattr(KernelCache, "__init__", nowhere)
    monkeypatch.setattr(kernels, "_said", set())
    for number in (1.0, 5.0):  # two kernels
        assert compiled()(lambda x, number=number: x + number)(1.0) == 1.0 + number
    assert [record.message for record in caplog.records].count(
        "no place to keep compiled kernels: RuntimeError: cannot cache function: no locator available"
    ) == 1


def test_a_full_disk_is_one_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    """One for all kernels, although each of them names another file."""
    monkeypatch.setattr(config, "CACHE_DIR", str(tmp_path))
    monkeypatch.setattr(kernels, "_said", set())

    def full(*_: Any) -> None:
        raise OSError(28, "No space left on device", f"file {len(caplog.records)}")

    for number in (2.0, 3.0):
        kernel = compiled()(lambda x, number=number: x + number)
        monkeypatch.setattr(kernel._cache._cache_file, "save", full)
        assert (kernel(1.0), kernel(1)) == (1.0 + number, 1 + number)
    assert len([record for record in caplog.records if "No space left" in record.message]) == 1


def test_every_kernel_is_keyed_by_what_its_text_names() -> None:
    """Read from the source: whatever one of our modules gives to a kernel stands among what its key covers."""
    found = 0
    cached = type(compiled()(lambda x: x)._cache)  # another kind where no folder can be written to
    for module in modules():
        tree = ast.parse(Path(str(module.__file__)).read_text())
        given = {
            alias.asname or alias.name: (node.module, alias.name)
            for node in tree.body
            if isinstance(node, ast.ImportFrom) and str(node.module).startswith("safestart")
            for alias in node.names
        }
        for node in tree.body:
            if not isinstance(node, ast.FunctionDef) or not any(
                "compiled" in ast.unparse(d) for d in node.decorator_list
            ):
                continue
            found += 1
            kernel = getattr(module, node.name)
            assert type(kernel._cache) is cached, f"{module.__name__}.{node.name}"
            covered = lines_of(kernel)
            body = [name.id for part in node.body for name in ast.walk(part) if isinstance(name, ast.Name)]
            for name in set(body) & set(given):
                source, original = given[name]
                value = getattr(importlib.import_module(source), original)
                wanted = f"value of {name}: {value!r}"
                if isinstance(value, ModuleType):
                    wanted = f"text of {value.__name__}: "
                elif hasattr(value, "py_func") or isinstance(value, type):
                    wanted = f"text of {value.__module__}: "
                assert any(line.startswith(wanted) for line in covered), (
                    f"{module.__name__}.{node.name}: {name}"
                )
    assert found > 30


def test_no_kernel_goes_round_the_keyed_cache() -> None:
    root = Path(str(safestart.__file__)).parent
    assert [str(file) for file in root.rglob("*.py") if "cache=True" in file.read_text()] == []


def test_a_kernel_is_machine_code_only_where_python_calls_it() -> None:
    """Its caller has its code inside; both give the same value, whoever is called first."""
    inner = compiled()(lambda x, by=3.0: by * x)
    outer = compiled()(lambda x: inner(x) + inner(x, 0.5))
    assert outer(2.0) == 7.0
    assert not inner.overloads
    assert inner(2.0) == 6.0
    assert len(inner.overloads) == 1
    assert outer(4) == 14.0


def test_a_literal_argument_is_no_compilation_of_its_own() -> None:
    inner = compiled()(lambda x, k: x + k)
    outer = compiled()(lambda x: inner(x, 1) + inner(x, 2) + inner(x, len((x, x))))
    seen: list[Any] = []

    class Compilations(event.Listener):
        def on_start(self, event: Any) -> None:
            seen.append(event.data["dispatcher"].py_func)

        def on_end(self, event: Any) -> None:
            pass

    with event.install_listener("numba:compile", Compilations()):
        assert outer(1.0) == 8.0
    assert seen.count(inner.py_func) == 1


def test_a_warm_up_leaves_the_collector_as_it_was(monkeypatch: pytest.MonkeyPatch) -> None:
    """Off while it compiles; on again after an error, too, and left off where it was off."""
    inside: list[bool] = []

    def part() -> None:
        inside.append(gc.isenabled())
        raise RuntimeError

    monkeypatch.setattr(warmup, "PARTS", {"one": part})
    for before in (True, False):
        (gc.enable if before else gc.disable)()
        try:
            with pytest.raises(RuntimeError):
                warmup.warm("one")
            assert gc.isenabled() is before
        finally:
            gc.enable()
    assert inside == [False, False]
