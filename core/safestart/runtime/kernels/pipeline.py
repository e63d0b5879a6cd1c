"""Numba's compiler without its last steps, for kernels that only kernels call: made for one version of Numba."""

from __future__ import annotations

from typing import Any

from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import CompilerBase, DefaultPassBuilder
from numba.core.compiler_machinery import LoweringPass, register_pass
from numba.core.typed_passes import AnnotateTypes


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


class PartCompiler(CompilerBase):
    """Numba's own passes, with the library of a part."""

    def define_pipelines(self) -> list[Any]:
        """The one pipeline."""
        passes = DefaultPassBuilder.define_nopython_pipeline(self.state)
        passes.add_pass_after(_IntoPart, AnnotateTypes)
        passes.finalize()
        return [passes]
