"""Any controller within a chaser's thrust: what it commands is checked, and cut to the limit."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Protocol

import numpy as np

from safestart.control.controller import Command
from safestart.errors import invalid
from safestart.model.scenario import Floats

if TYPE_CHECKING:
    from numpy.typing import ArrayLike


class Steering(Protocol):
    """A user's controller: returns LVLH thrust (3,), m/s², or our command, for interval ``k`` and state (6,)."""

    def command(self, k: int, state: Floats, /) -> Command | ArrayLike:
        """Thrust to hold over the interval."""
        ...


class Limited:
    """A controller in our loop; thrust beyond ``a_max`` (m/s²) is cut to it. Its ``begin`` is called if it has one.

    ``command`` raises ``InvalidInput`` for thrust of another shape than (3,), or that is not finite.
    """

    def __init__(self, inner: Steering, a_max: float) -> None:
        self._inner, self._a_max = inner, a_max

    def begin(self, state: Floats) -> None:
        """Pass the start to a controller with a ``begin`` method."""
        begin = getattr(self._inner, "begin", None)
        if begin is not None:
            begin(state)

    def command(self, k: int, state: Floats) -> Command:
        """See :class:`safestart.control.controller.Controller`."""
        found = self._inner.command(k, state)
        given = found if isinstance(found, Command) else Command(_numbers(found))
        if np.shape(given.thrust) != (3,) or not np.isfinite(given.thrust).all():
            raise invalid("thrust", "shape (3,), finite, m/s²", np.asarray(given.thrust).tolist())
        size = float(np.sqrt(given.thrust @ given.thrust))
        return replace(given, thrust=given.thrust * (self._a_max / size)) if size > self._a_max else given


def _numbers(found: ArrayLike) -> Floats:
    try:
        return np.array(found, dtype=np.float64)
    except (TypeError, ValueError):
        raise invalid("thrust", "shape (3,), finite, m/s²", found) from None
