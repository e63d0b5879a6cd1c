"""`certify`: the sound certificate of starts at rest, in microseconds each."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from safestart.closed_form.certified import ROUNDING
from safestart.closed_form.certified import certify as certify_starts
from safestart.closed_form.manoeuvre import Manoeuvre, manoeuvre_of
from safestart.errors import invalid
from safestart.model.scenario import Bools, Floats, Rest, Scenario
from safestart.public.shown import COLOURS, Shown
from safestart.public.starts import points_of, rest_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from numpy.typing import ArrayLike


@dataclass(frozen=True, slots=True, eq=False)
class Certificates(Shown):
    """The certificate of starts, arrays of their shape (...).

    ``points_m`` (..., d), body frame, metres. ``verdict`` (...): ``GO``, a known manoeuvre stays in the corridor for
    ever; ``NO_GO``, the start is outside; else ``UNDECIDED``. ``margin_m`` (...), metres: for GO the manoeuvre's
    distance to every face is at least this at all times; for NO_GO the start's own, negative; else NaN.
    """

    scenario: Scenario
    points_m: Floats
    rest: Rest
    verdict: NDArray[np.str_]
    margin_m: Floats

    @property
    def go(self) -> Bools:
        """Where the verdict is GO, (...)."""
        return np.asarray(self.verdict == "GO")

    def manoeuvre(self, *index: int) -> Manoeuvre | None:
        """The manoeuvre behind the GO of one start, by its index in (...); None for another verdict.

        ``motion(times)`` and ``thrust(times)`` in the body frame, ``thrust_lvlh(times)``; arrays (T, 3) at ``times``
        (T,), s, from the start on for ever. Raises ``InvalidInput`` for an index that names no one start.
        """
        if len(index) != self.verdict.ndim or any(
            not -n <= k < n for k, n in zip(index, self.verdict.shape, strict=True)
        ):
            raise invalid("index", f"an index of one start of shape {self.verdict.shape}", index)
        return manoeuvre_of(self.scenario, self.points_m[index], self.rest) if self.go[index] else None

    def facts(self) -> Mapping[str, object]:
        """Number of starts by verdict."""
        counts = {word: int(np.count_nonzero(self.verdict == word)) for word in COLOURS}
        return {"starts": int(self.verdict.size), **counts}

    def columns(self) -> Mapping[str, Any]:
        """One row for each start."""
        flat = self.points_m.reshape(-1, self.points_m.shape[-1])
        axes = dict(zip(("x_m", "y_m", "z_m"), flat.T, strict=False))
        return {**axes, "verdict": self.verdict.ravel(), "margin_m": self.margin_m.ravel()}

    def draw(self, axes: Axes) -> None:
        """The starts in the corridor, x and y, coloured by their verdicts."""
        from safestart.processes.plotting import draw_corridor

        flat, words = self.points_m.reshape(-1, self.points_m.shape[-1]), self.verdict.ravel()
        farthest = max(float(flat[:, 1].max(initial=0.0)), 2.0 * self.scenario.corridor.hold_radius + 10.0)
        draw_corridor(axes, self.scenario.corridor, 1.1 * farthest)
        for word, colour in COLOURS.items():
            some = flat[words == word]
            if len(some):
                axes.scatter(some[:, 0], some[:, 1], s=9, color=colour, label=word, zorder=3)
        if len(flat):
            axes.legend(loc="lower right")


def certify(scenario: Scenario, points: ArrayLike, rest: Rest | str = Rest.LVLH) -> Certificates:
    """Certify starts at rest at body-frame ``points`` (..., 2) or (..., 3), metres (docs/theory/certified.md).

    ``rest`` is the frame in which they are at rest, ``lvlh`` or ``body``. Raises ``InvalidInput`` for points of another
    shape, not finite or beyond 10 km.
    """
    given, rest = points_of(points), rest_of(rest)
    found = certify_starts(scenario, given, rest)
    # A start on a face, within rounding, does not count as outside.
    outside = (found.binding < len(found.names) - 1) & (found.margin < -2.0 * ROUNDING)
    outside &= _outside(scenario, given)
    verdict = np.where(found.go, "GO", np.where(outside, "NO_GO", "UNDECIDED"))
    margin = np.where(verdict == "UNDECIDED", np.nan, found.margin)
    return Certificates(scenario, given, rest, verdict, margin)


def _outside(scenario: Scenario, points: Floats) -> Bools:
    from safestart.constraints.corridor import corridor_of

    slack = corridor_of(scenario.corridor, points.shape[-1]).slack(points)
    return np.asarray((slack < 0.0).any(axis=-1))
