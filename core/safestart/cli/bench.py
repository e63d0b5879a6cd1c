"""``safestart bench``: every benchmark beside its peer, in one run."""

from __future__ import annotations

import importlib
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any

import typer

import safestart
from safestart.cli.console import Json, err, out, print_json, table_of
from safestart.errors import Unavailable
from safestart.records.provenance import versions


def register(app: typer.Typer) -> None:
    """Add the command."""

    @app.command("bench")
    def bench(
        as_json: Json = False,
        curves: Annotated[
            Path | None,
            typer.Option(
                help="Measure instead how time and memory grow with starts, horizon, nodes, flights and jobs; "
                "writes curves.json, curves.png and curves.md into this folder.",
                file_okay=False,
            ),
        ] = None,
    ) -> None:
        """Time each engine beside its peer on this machine (a checkout is needed: the peers are not shipped).

        What cannot be measured is said on stderr, and in the document under "missing"; the exit code is then 1.
        """
        suite = _suite()
        if curves is not None:
            found = importlib.import_module("benchmarks.curves.written").write(curves, say=err.print)
            if as_json:
                print_json(found)
            return
        document = measured(suite.BENCHMARKS) | {"machine": versions()["machine"]}
        if as_json:
            print_json(document)
        else:
            _show(document)
        if document["missing"]:
            raise typer.Exit(1)


def measured(names: Sequence[str]) -> dict[str, Any]:
    """Ratios and times of these benchmarks; of one that fails only the reason, under ``missing`` and on stderr.

    A run takes many minutes, and what a busy machine breaks in one benchmark says nothing about the others.
    """
    ratios: dict[str, float] = {}
    times: dict[str, float] = {}
    missing: dict[str, str] = {}
    for name in names:
        err.print(f"{name} ...")
        try:
            found = importlib.import_module(f"benchmarks.{name}").measure()
            add(ratios, found["ratios"], name)
            add(times, found["times"], name)
        except Exception as error:
            missing[name] = _reason(error)
            err.print(f"{name} is missing: {missing[name]}", markup=False, soft_wrap=True)
    return {"ratios": ratios, "times": times, "missing": missing}


def _reason(error: Exception) -> str:
    """One line; many errors, such as a ``TimeoutError``, have no text of their own."""
    first = next(iter(str(error).strip().splitlines()), "")
    return f"{type(error).__name__}: {first}" if first else type(error).__name__


def add(figures: dict[str, float], measured: dict[str, float], benchmark: str) -> None:
    """Add what a benchmark measured. A name must be new: one figure would silently take the place of another."""
    if taken := sorted(figures.keys() & measured.keys()):
        raise ValueError(f"{benchmark}: required names that no other benchmark uses, received {taken}")
    figures.update(measured)


def _suite() -> Any:
    root = Path(safestart.__file__).resolve().parents[2]
    if not (root / "benchmarks" / "__init__.py").is_file():
        raise Unavailable(f"bench: required a checkout with its benchmarks/ folder, found none at {root}")
    sys.path.insert(0, str(root))
    return importlib.import_module("benchmarks")


def _show(document: dict[str, Any]) -> None:
    for title, unit in (("ratios", "x"), ("times", "s")):
        shown = f"{title} (medians, one run, compile time apart)"
        table = table_of(shown, [(title, "left"), (unit, "right")])
        for key, value in document[title].items():
            table.add_row(key, f"{value:,.3g}" if unit == "s" else f"{value:,.2f}")
        out.print(table)
