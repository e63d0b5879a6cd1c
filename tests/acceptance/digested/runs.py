"""Answers for the digests, in a process of its own: ``python -m tests.acceptance.digested.runs NAME ...``.

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

from tests.acceptance.digested import content
from tests.acceptance.digested.calls import COMMANDS
from tests.acceptance.digested.questions import asked

Answer = dict[str, bytes]
"""Files by name: ``document.json`` and whatever came with it."""


def run(name: str) -> Answer:
    """The files that answer a question."""
    if name not in COMMANDS:
        return executed(name)
    printed, left = commands(COMMANDS[name])
    return {f"printed-{place + 1}.json": _text(said) for place, said in enumerate(printed)} | left


def executed(name: str) -> Answer:
    """The document of a process, its artifacts, and what the checker says of each proof among them."""
    from safestart.processes.execute import execute

    process_id, questions = asked(name)
    for inputs in questions:
        found = execute(process_id, inputs)
    files = {"document.json": _text(found.document)} | {item.name: item.data for item in found.artifacts}
    documents = [json.loads(data) for file, data in files.items() if file.endswith(".json")]
    proofs = {f"{place}.json": _text(proof) for place, proof in enumerate(proofs_in(documents))}
    if proofs:
        verified, _ = commands(tuple(("verify", proof, "--json") for proof in proofs), proofs)
        files["verified.json"] = _text(verified)
    return files


def proofs_in(value: Any) -> list[Any]:
    """Proof documents, wherever they stand."""
    if isinstance(value, dict) and str(value.get("schema")).startswith("safestart-proof"):
        return [value]
    inner = value.values() if isinstance(value, dict) else value if isinstance(value, list) else ()
    return [proof for item in inner for proof in proofs_in(item)]


def commands(lines: tuple[tuple[str, ...], ...], given: Answer | None = None) -> tuple[list[Any], Answer]:
    """The output of command lines in a folder of ``given`` files, and the files that they leave there."""
    (point,) = entry_points(group="console_scripts", name="safestart")
    main = point.load()
    with TemporaryDirectory() as folder, contextlib.chdir(folder):
        for name, data in (given or {}).items():
            Path(name).write_bytes(data)
        printed = [_printed(main, words) for words in lines]
        return printed, {path.name: path.read_bytes() for path in sorted(Path().iterdir())}


def _printed(main: Any, words: tuple[str, ...]) -> Any:
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
    return {"exit": code, "printed": json.loads(out.getvalue() or "null")}


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
    except Exception as error:  # an error in one answer is reported for that answer
        return {"error": f"{type(error).__name__}: {error}"}


def main(kept: str, names: list[str]) -> None:
    """Answer each question in a fork of its own; two lines for each: the answer, and seconds of processor time.

    What one question leaves in memory (an atlas is kept there, and answers later questions) is not there for the next.
    """
    stdout = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)  # other printed lines are not ours
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
