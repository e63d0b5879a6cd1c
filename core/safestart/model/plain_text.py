"""Text that stays in its line: names that files, lists and messages show beside other text."""

from __future__ import annotations

import re

from safestart.errors import invalid

# Controls, line separators, and the marks that turn the direction of the text after them: a list shows many texts.
UNPRINTED = r"\x00-\x08\x0b-\x1f\x7f-\x9f\u2028-\u202e\u2066-\u2069"
"""Characters that no text has, for a pattern; tabs and line feeds besides where it is one line."""
_OUT_OF_LINE = re.compile(rf"[\t\n{UNPRINTED}\ud800-\udfff]")


def require_line(field: str, text: str) -> None:
    """Raise ``InvalidInput`` unless ``text`` is one line of text: in a message, a line end would begin a statement."""
    if _OUT_OF_LINE.search(text):
        raise invalid(field, "one line of text, without control characters", text)
