"""How a kernel is compiled where another kernel calls it: into the caller's machine code, and nowhere else.

Numba optimises every function by itself and turns it into machine code, then links it into its caller and does both
again there: the body of a loop is compiled once for each level above it. A part stops before that. Its caller links
its code as it came from the types and optimises all of it once, and so a first start saves a fifth of its time.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from numba import njit, types
from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import CompilerBase, DefaultPassBuilder
from numba.core.compiler_machinery import LoweringPass, register_pass
from numba.core.typed_passes import AnnotateTypes


def part(function: Callable[..., Any], **options: Any) -> Any:
    """``function`` for callers in kernels only, with Numba's ``options``; Python must not call it.

    It is compiled once for the types of its arguments: for a literal one Numba would compile it for the literal and
    again for its type, and a loop's counter, which starts as the literal 0, is one.
    """
    bare = {"no_cpython_wrapper": True, "no_cfunc_wrapper": True, "pipeline_class": _PartCompiler}
    found = njit(**{**options, **bare})(function)
    template = found.get_call_template

    def for_types(args: Any, kws: Any) -> Any:
        return template(
            tuple(map(types.unliteral, args)), {name: types.unliteral(one) for name, one in kws.items()}
        )

    found.get_call_template = for_types
    return found


class _NoEnvironments:
    """A code generator that is not asked to fill in what only machine code has: the place of an environment."""

    def __init__(self, codegen: Any) -> None:
        self._codegen = codegen

    def __getattr__(self, name: str) -> Any:
        return getattr(self._codegen, name)

    def set_env(self, env_name: str, env: Any) -> None:
        """Nothing: Python calls no part, so none needs its environment."""


class _PartLibrary(JITCodeLibrary):
    """Code to link into callers, neither optimised as a whole nor turned into machine code."""

    @property
    def codegen(self) -> Any:
        """The code generator, which has no machine code of this library."""
        return _NoEnvironments(super().codegen)

    def get_pointer_to_function(self, name: str) -> int:  # noqa: ARG002
        """0, as Numba says of a function that has no machine code."""
        return 0

    def _optimize_final_module(self) -> None:
        """Callers optimise it with their own."""

    def _finalize_final_module(self) -> None:
        self._finalize_dynamic_globals()
        self._verify_declare_only_symbols()
        self._finalized = True


@register_pass(mutates_CFG=False, analysis_only=False)
class _IntoPart(LoweringPass):
    """Lower into a :class:`_PartLibrary`."""

    _name = "safestart_into_part"

    def __init__(self) -> None:
        LoweringPass.__init__(self)

    def run_pass(self, state: Any) -> bool:
        """Give the lowering that follows its library."""
        state.library = _PartLibrary(state.targetctx.codegen(), state.func_id.func_qualname)
        return True


class _PartCompiler(CompilerBase):
    """Numba's own passes, with the library of a part."""

    def define_pipelines(self) -> list[Any]:
        """The one pipeline."""
        passes = DefaultPassBuilder.define_nopython_pipeline(self.state)
        passes.add_pass_after(_IntoPart, AnnotateTypes)
        passes.finalize()
        return [passes]
