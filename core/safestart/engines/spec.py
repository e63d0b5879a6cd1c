"""What is known of an engine without loading it: name, title, colour, options."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from safestart.model.wire_model import WireModel

LineStyle = Literal["-", "--", ":", "-."]


@dataclass(frozen=True, slots=True)
class EngineSpec:
    """An engine as every picture, form and page shows it.

    ``name`` is what requests, documents and arrays call it, ``title`` what people read. ``colour`` (#RRGGBB) is its
    colour in every picture, ``screen_colour`` the one on pages, light and dark, where that must differ. ``line`` is
    the style of its outline; an engine without one is drawn filled. ``engine`` names the class as ``module:class``,
    which is imported only where it runs. ``options`` is the model of its options as they cross the wire: a field of
    the benchmark's inputs that is called as the engine. ``share`` is its part of a benchmark's time, against 1 for a
    fast engine.
    """

    name: str
    title: str
    colour: str
    engine: str
    summary: str
    line: LineStyle | None = "-"
    options: type[WireModel] | None = None
    share: float = 1.0
    screen_colour: str | None = None

    def document(self) -> dict[str, str]:
        """What pages need to show it, JSON-able."""
        return {
            "name": self.name,
            "title": self.title,
            "colour": self.screen_colour or self.colour,
            "summary": self.summary,
        }
