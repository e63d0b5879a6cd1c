"""The curves as a picture and as a table."""

from __future__ import annotations

from collections.abc import Mapping
from math import ceil
from pathlib import Path
from typing import Any

from benchmarks.curves.works import CURVES
from safestart.processes.plotting import figure

_COLUMNS = 4
_TIME, _MEMORY = "#0072B2", "#D55E00"


def picture(found: Mapping[str, Any], path: Path) -> None:
    """A panel for each curve: seconds on the left in blue, MiB on the right in orange, both logarithmic."""
    page = figure(4.1 * _COLUMNS, 3.2 * ceil(len(found) / _COLUMNS))
    for place, (name, curve) in enumerate(found.items(), 1):
        axes = page.add_subplot(ceil(len(found) / _COLUMNS), _COLUMNS, place)
        amounts = [point["amount"] for point in curve["points"]]
        axes.loglog(amounts, [point["seconds"] for point in curve["points"]], "o-", color=_TIME, markersize=4)
        axes.set_title(
            f"{CURVES[name].title}\ntime grows with power {curve['exponents']['time']:.2f}", fontsize=10
        )
        axes.set_xlabel(CURVES[name].axis.replace("s horizon", "horizon [s]"))
        axes.set_ylabel("processor time [s]", color=_TIME)
        axes.grid(alpha=0.3)
        if max(amounts) < 100 * min(amounts):
            # Less than two decades: the powers of ten say little.
            axes.set_xticks(amounts, [f"{amount:g}" for amount in amounts])
            axes.set_xticks([], minor=True)
        if curve["exponents"]["memory"] is not None:
            right = axes.twinx()
            heavy = [point for point in curve["points"] if point["mib"] > 0.1]
            right.loglog(
                [point["amount"] for point in heavy], [point["mib"] for point in heavy], "s--", color=_MEMORY,
                markersize=3,
            )  # fmt: skip
            right.set_ylabel("memory [MiB]", color=_MEMORY)
    page.savefig(path, dpi=80)


def table(found: Mapping[str, Any]) -> str:
    """The largest size of each curve and the powers, in Markdown."""
    lines = [
        "| what | largest | processor time | memory | power of time | power of memory |",
        "|---|---|---|---|---|---|",
    ]
    for name, curve in found.items():
        most = curve["points"][-1]
        power = curve["exponents"]["memory"]
        lines.append(
            f"| {CURVES[name].title} | {_spaced(most['amount'])} {CURVES[name].axis} | {_seconds(most['seconds'])} | "
            f"{most['mib']:.0f} MiB | {curve['exponents']['time']:.2f} | {'-' if power is None else f'{power:.2f}'} |"
        )
    return "\n".join(lines) + "\n"


def _spaced(value: int) -> str:
    return f"{value:,}".replace(",", " ")


def _seconds(value: float) -> str:
    return f"{value:.3g} s" if value >= 0.1 else f"{1e3 * value:.3g} ms"
