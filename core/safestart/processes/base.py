"""What a process is: a description with typed inputs and outputs, and a pure function of (inputs, context)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from importlib import import_module
from typing import Any

from pydantic import BaseModel, ConfigDict, ValidationError

from safestart.artifact import Artifact as Artifact
from safestart.progress import Context
from safestart.validation import validation_error


class WireModel(BaseModel):
    """Base of every model that crosses the wire: unknown fields are refused, NaN and infinity too."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False, strict=False)


@dataclass(frozen=True, slots=True)
class ProcessOutput:
    """What a process returns: a JSON-able document and its artifacts."""

    document: dict[str, Any]
    artifacts: tuple[Artifact, ...] = ()


Runner = Callable[[Any, Context], ProcessOutput]


@dataclass(frozen=True, slots=True)
class ProcessSpec:
    """Description of a process; light to import, so that the service can offer what it cannot run.

    ``run`` names the function as ``module:function``; it is imported only where the process executes.
    ``light`` processes may run synchronously inside the service; all others are async-execute only.
    ``instant`` names a function (inputs) -> document that the service answers with at submission.
    """

    id: str
    title: str
    description: str
    inputs: type[WireModel]
    outputs: type[WireModel]
    run: str
    light: bool = False
    instant: str | None = None
    version: str = "1.0.0"
    keywords: tuple[str, ...] = ()
    example: dict[str, Any] = field(default_factory=dict)

    def parse(self, inputs: Any) -> WireModel:
        """Validate raw inputs; raises ``InvalidInput`` naming the first field, what it requires, what came."""
        try:
            return self.inputs.model_validate(inputs)
        except ValidationError as error:
            raise validation_error(error) from None

    def runner(self) -> Runner:
        """Import and return the function that executes this process."""
        return _load(self.run)

    def instant_answer(self, inputs: WireModel) -> dict[str, Any] | None:
        """The document that is known at once, before any engine has run, or None."""
        return None if self.instant is None else _load(self.instant)(inputs)


def _load(target: str) -> Callable[..., Any]:
    module, name = target.split(":")
    function: Callable[..., Any] = getattr(import_module(module), name)
    return function
