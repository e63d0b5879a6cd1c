"""Shared by all results: a picture in a notebook, a table of facts, a data frame."""

from __future__ import annotations

import base64
import io
from abc import ABC, abstractmethod
from collections.abc import Mapping
from html import escape
from typing import TYPE_CHECKING, Any

from safestart.errors import Unavailable

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes

SIZE_IN = (6.4, 4.8)
COLOURS = {"GO": "#0072B2", "NO_GO": "#D55E00", "UNDECIDED": "#999999"}


class Shown(ABC):
    """A result that plots itself.

    A notebook shows :meth:`facts` beside the picture, or only the facts without matplotlib.
    """

    __slots__ = ()

    @abstractmethod
    def facts(self) -> Mapping[str, object]:
        """A few facts of the result, by name."""

    @abstractmethod
    def draw(self, axes: Axes) -> None:
        """Draw the result into the axes."""

    @abstractmethod
    def columns(self) -> Mapping[str, Any]:
        """Columns of the data frame, all of one length."""

    def plot(self, axes: Axes | None = None) -> Axes:
        """Draw into ``axes``, or into a new figure (``.figure`` of the returned axes; no pyplot).

        Raises ``Unavailable`` if matplotlib is not installed.
        """
        if axes is None:
            axes = _new_axes()
        self.draw(axes)
        return axes

    def to_dataframe(self) -> pd.DataFrame:
        """The result as a pandas data frame; raises ``Unavailable`` if pandas is not installed."""
        return frame_of(self.columns())

    def _repr_png_(self) -> bytes | None:
        try:
            axes = self.plot()
        except Unavailable:
            return None
        buffer = io.BytesIO()
        axes.get_figure(root=True).savefig(buffer, format="png", dpi=110)  # type: ignore[union-attr]
        return buffer.getvalue()

    def _repr_html_(self) -> str:
        return html_of(type(self).__name__, self.facts(), self._repr_png_())


def html_of(title: str, facts: Mapping[str, object], png: bytes | None) -> str:
    """A table of facts and a picture as one piece of HTML; every text is escaped."""
    rows = "".join(
        f"<tr><th style='text-align:left'>{escape(name)}</th><td style='text-align:left'>{escape(str(value))}</td></tr>"
        for name, value in facts.items()
    )
    picture = ""
    if png is not None:
        data = base64.b64encode(png).decode("ascii")
        picture = f'<img alt="{escape(title)}" src="data:image/png;base64,{data}">'
    return f"<div><table>{rows}</table>{picture}</div>"


def frame_of(columns: Mapping[str, Any]) -> pd.DataFrame:
    """A data frame; raises ``Unavailable`` if pandas is not installed."""
    try:
        import pandas as pd
    except ImportError:
        raise Unavailable("to_dataframe: required the package pandas, which is not installed") from None
    return pd.DataFrame(dict(columns))


def _new_axes() -> Axes:
    try:
        from matplotlib.figure import Figure
    except ImportError:
        raise Unavailable(
            "plot: required the package matplotlib (safestart[engines]), which is not installed"
        ) from None
    return Figure(figsize=SIZE_IN, layout="constrained").subplots()
