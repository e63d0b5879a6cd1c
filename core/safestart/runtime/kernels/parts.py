"""How a kernel is compiled where another kernel calls it: into the caller's machine code, and nowhere else.

Numba optimises every function by itself and turns it into machine code, then links it into its caller and does both
again there: the body of a loop is compiled once for each level above it. A part stops before that. Its caller links
its code as it came from the types and optimises all of it once, and so a first start saves a fifth of its time.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from numba import njit, types, version_info

KNOWN = (0, 68)
"""The version of Numba whose inner classes :mod:`safestart.runtime.kernels.pipeline` extends. With another one parts
are compiled as Numba does it: the same bits, later."""


def part(function: Callable[..., Any], **options: Any) -> Any:
    """``function`` for callers in kernels only, with Numba's ``options``; Python must not call it.

    It is compiled once for the types of its arguments: for a literal one Numba would compile it for the literal and
    again for its type, and a loop's counter, which starts as the literal 0, is one.
    """
    bare = {"no_cpython_wrapper": True, "no_cfunc_wrapper": True, **_pipeline()}
    found = njit(**{**options, **bare})(function)
    template = found.get_call_template

    def for_types(args: Any, kws: Any) -> Any:
        return template(
            tuple(map(types.unliteral, args)), {name: types.unliteral(one) for name, one in kws.items()}
        )

    found.get_call_template = for_types
    return found


def _pipeline() -> dict[str, Any]:
    if tuple(version_info[:2]) != KNOWN:
        return {}
    from safestart.runtime.kernels.pipeline import PartCompiler

    return {"pipeline_class": PartCompiler}
