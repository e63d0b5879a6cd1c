"""Facts about an engine, without loading it: name, title, colour, options."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Literal

from safestart.model.wire_model import WireModel
from safestart.runtime.named import misregistered

_NAME, _COLOUR = re.compile(r"[a-z][a-z0-9_]*"), re.compile(r"#[0-9A-Fa-f]{6}")
LineStyle = Literal["-", "--", ":", "-."]


@dataclass(frozen=True, slots=True)
class EngineSpec:
    """How every picture, form and page shows an engine.

    ``name`` is its name in requests, documents and arrays, ``title`` the one for people. ``colour`` (#RRGGBB) is its
    colour in every picture, ``screen_colour`` the one on pages, light and dark, if that must differ. ``line`` is the
    style of its outline; an engine without one is drawn filled. ``engine`` names the class as ``module:class``,
    imported only where it runs. ``options`` is the wire model of its options: the field of the benchmark's inputs with
    the engine's name. ``default``: a benchmark that names no engines runs it. ``share`` is its part of a benchmark's
    time, relative to 1 for a fast engine. ``in_space`` names its form for a plane of starts in space, ``module:class``;
    without one ``not_in_space`` says why.
    """

    name: str
    title: str
    colour: str
    engine: str
    summary: str
    line: LineStyle | None = "-"
    options: type[WireModel] | None = None
    share: float = 1.0
    default: bool = True
    screen_colour: str | None = None
    in_space: str = ""
    not_in_space: str = "planar"

    def __post_init__(self) -> None:
        """Raise ``Misregistered`` for a name that is none in Python and JSON, and for a colour of another form."""
        if not _NAME.fullmatch(self.name):
            raise misregistered("name of an engine", "small letters, digits and _", self.name)
        for colour in (self.colour, self.screen_colour):
            if colour is not None and not _COLOUR.fullmatch(colour):
                raise misregistered(f"colour of engine {self.name}", "#RRGGBB", colour)

    def document(self) -> dict[str, str]:
        """The facts that pages show, JSON-able."""
        return {
            "name": self.name,
            "title": self.title,
            "colour": self.screen_colour or self.colour,
            "summary": self.summary,
        }
