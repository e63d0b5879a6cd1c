"""Answers for the digests, in a process of its own: ``python -m tests.acceptance.digest_runs NAME ...``.

It stands on what stays: ``execute`` and ``process`` of the core, the command line by its entry point. One line of
JSON per answer goes to the standard output, with a folder of the answers themselves where one is named.
"""

from __future__ import annotations

import contextlib
import io
import json
import os
import sys
from collections.abc import Callable
from functools import partial
from importlib import import_module
from importlib.metadata import entry_points
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from tests.acceptance import digest_content as content
from tests.acceptance.digest_questions import COMMANDS, asked

Answer = dict[str, bytes]
"""Files by name: ``document.json`` and whatever came with it."""


def run(name: str) -> Answer:
    """The files that answer a question."""
    return command(COMMANDS[name]) if name in COMMANDS else executed(name)


def executed(name: str) -> Answer:
    """The document of a process and its artifacts."""
    from safestart.processes.execute import execute

    process_id, questions = asked(name)
    for inputs in questions:
        found = execute(process_id, inputs)
    return {"document.json": _text(found.document)} | {item.name: item.data for item in found.artifacts}


def command(lines: tuple[tuple[str, ...], ...]) -> Answer:
    """What command lines print, and the files that they leave in an empty folder."""
    (point,) = entry_points(group="console_scripts", name="safestart")
    main = point.load()
    printed = {}
    with TemporaryDirectory() as folder, contextlib.chdir(folder):
        for place, words in enumerate(lines):
            printed[f"printed-{place + 1}.json"] = _printed(main, words)
        left = {path.name: path.read_bytes() for path in sorted(Path().iterdir())}
    return printed | left


def _printed(main: Any, words: tuple[str, ...]) -> bytes:
    out = io.StringIO()
    code: Any = 0
    before, sys.argv = sys.argv, ["safestart", *words]
    try:
        with contextlib.redirect_stdout(out):
            main()
    except SystemExit as end:
        code = end.code or 0
    finally:
        sys.argv = before
    return _text({"exit": code, "printed": json.loads(out.getvalue() or "null")})


def digests(answer: Answer) -> dict[str, content.Digests]:
    """Digests of each file of an answer."""
    return {name: content.file(name, data) for name, data in answer.items()}


def keep(folder: Path, answer: Answer) -> None:
    """Write an answer, documents in lines and without times: made to be compared by ``diff -r``."""
    folder.mkdir(parents=True, exist_ok=True)
    for name, data in answer.items():
        if name.endswith(".json"):
            data = json.dumps(content.comparable(json.loads(data)), indent=1).encode()
        path = folder / name
        path.parent.mkdir(exist_ok=True)
        path.write_bytes(data)


def _text(document: Any) -> bytes:
    return json.dumps(document, allow_nan=False).encode()


LIBRARIES = (
    *("numpy", "scipy.linalg", "scipy.optimize", "scipy.integrate", "numba", "clarabel", "flint"),
    *("matplotlib.figure", "matplotlib.backends.backend_agg", "pyarrow.parquet", "typer"),
    "safestart.processes.execute",
)
"""Loaded once, before the first question."""


def told(name: str, kept: str, asked_for: Callable[[], Answer]) -> dict[str, Any]:
    """What came of a question: its digests, or why there are none."""
    try:
        answer = asked_for()
        if kept:
            keep(Path(kept, name), answer)
        return {"files": digests(answer)}
    except Exception as error:  # whatever breaks one answer is told of that one
        return {"error": f"{type(error).__name__}: {error}"}


def main(kept: str, names: list[str]) -> None:
    """Answer each question in a fork of its own; two lines for each: the answer, and seconds of processor time.

    What one question leaves in memory (an atlas is kept there, and answers later questions) is not there for the next.
    """
    stdout = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)  # whatever else is printed is no line of ours
    for library in LIBRARIES:
        import_module(library)
    registry = import_module("safestart.processes.registry")
    for process_id in registry.PROCESS_IDS:
        registry.process(process_id)
    for name in names:
        stdout.flush()
        child = os.fork()
        if child == 0:
            stdout.write(json.dumps(told(name, kept, partial(run, name))))
            stdout.flush()
            os._exit(0)
        _, _, used = os.wait4(child, 0)
        stdout.write(f"\n{used.ru_utime + used.ru_stime}\n")
    stdout.flush()


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2:])
