"""Numbers in text, on the command line as in a query: as JSON writes them, since anything else is likelier a slip.

``float`` takes ``1_0`` for 10, ``٣`` for 3, and spaces around; whoever typed ``--x-m 1_0`` may have meant 1.0.
"""

from __future__ import annotations

import re
from typing import Any, get_args

from safestart.errors import invalid

GROUPED = re.compile(r"\d_\d")


def require_plain(name: str, value: str) -> None:
    """Raise ``InvalidInput`` for a number with ``_``, a plus sign, spaces or digits other than 0 to 9."""
    if GROUPED.search(value):
        raise invalid(name, "a number without _ between its digits", value)
    if value != value.strip() or value.startswith("+"):
        raise invalid(name, "a number without spaces and without a plus sign", value)
    if not value.isascii():
        raise invalid(name, "a number in the digits 0 to 9", value)


def is_number(annotation: Any) -> bool:
    """Whether a parameter of this type is a number, several of them, or none."""
    return annotation in (int, float) or any(is_number(part) for part in get_args(annotation))
