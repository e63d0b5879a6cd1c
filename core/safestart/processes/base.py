"""A process: a description with typed inputs and outputs, and a pure function of (inputs, context)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from pydantic import ValidationError
from pydantic_core import PydanticSerializationError, to_json

from safestart.errors import UnfitResult
from safestart.model.validation import error_of, validation_error
from safestart.model.wire_model import WireModel as WireModel
from safestart.processes.output import ProcessOutput as ProcessOutput
from safestart.processes.sharding import Sharding, load
from safestart.processes.views import View
from safestart.records.artifact import Artifact as Artifact
from safestart.runtime.progress import Context

Runner = Callable[[Any, Context], ProcessOutput]


@dataclass(frozen=True, slots=True)
class Table:
    """How lists among the outputs make a table.

    Without ``axes`` the lists named in ``columns`` stand side by side, one row per entry. With two axes, each a list,
    the columns are maps over them, ``column[first][second]``, one row per cell.
    """

    name: str
    columns: tuple[str, ...]
    axes: tuple[str, str] | tuple[()] = ()


@dataclass(frozen=True, slots=True)
class ProcessSpec:
    """Description of a process; light to import, so that the service can offer processes that it cannot run.

    ``run`` names the function as ``module:function``, imported only where the process executes. A sharded process has
    ``sharding`` instead. ``light`` processes may run synchronously inside the service; all others are async-execute
    only; ``cost`` estimates the seconds of one core that an answer takes for given inputs. ``replay_tolerance`` bounds
    the deviation of a replay on another machine or with other versions, relative to max(1, |value|); on the same
    machine and versions a replay is equal bit for bit. ``instant`` names a function (inputs) -> document for the
    service's answer at submission. ``possible`` names a function (inputs) that raises ``InvalidInput`` for what no
    model can have: it is called before a job is queued, so that nobody waits for a refusal, and before a run.
    ``states`` names the input list, if any, that a service may limit further (``max_states``). ``kernels`` names the
    parts of :mod:`safestart.runtime.warmup` that its jobs need: a worker that
    has just started compiles those of waiting jobs first. ``tables`` declares tables over plain lists among the
    outputs; lists of objects are tables without a declaration. ``views`` say how a page shows the outputs, the most
    important first. ``courses`` names a function (inputs, outputs) -> ``FlightCourses`` or None where the outputs are a
    flight: the service then offers it as CCSDS messages and CZML. ``extensions`` are further members of its
    description, named ``safestart:...``.
    """

    id: str
    title: str
    description: str
    inputs: type[WireModel]
    outputs: type[WireModel]
    run: str = ""
    sharding: Sharding | None = None
    light: bool = False
    cost: Callable[[Any], float] = lambda _: 0.0
    instant: str | None = None
    possible: str | None = None
    courses: str | None = None
    version: str = "1.0.0"
    replay_tolerance: float = 1e-9
    keywords: tuple[str, ...] = ()
    states: str = ""
    kernels: tuple[str, ...] = ()
    tables: tuple[Table, ...] = ()
    views: tuple[View, ...] = ()
    extensions: dict[str, Any] = field(default_factory=dict)
    example: dict[str, Any] = field(default_factory=dict)

    def parse(self, inputs: Any) -> WireModel:
        """Validate raw inputs; raises ``InvalidInput`` naming the first field, what it requires, what came."""
        try:
            return self.inputs.model_validate(inputs)
        except ValidationError as error:
            raise validation_error(error, model=self.inputs) from None

    def check(self, document: dict[str, Any]) -> None:
        """Raise ``UnfitResult`` unless ``document``, in its stored JSON form, matches ``outputs``.

        Nothing is converted: text is not accepted as a number, 2.0 not as an integer, and NaN is refused.
        """
        try:
            self.outputs.model_validate_json(to_json(document, inf_nan_mode="constants"), strict=True)
        except ValidationError as error:
            raise error_of(UnfitResult, error.errors(include_url=False), "outputs.") from None
        except PydanticSerializationError as error:
            raise UnfitResult(
                f"outputs: required JSON, received something else ({error})", required="JSON"
            ) from None

    def runner(self) -> Runner:
        """Import and return the function that executes this process."""
        if self.sharding is None:
            return load(self.run)
        load(self.sharding.shard), load(self.sharding.merge)
        return self.sharding.run

    def require_possible(self, inputs: WireModel) -> None:
        """Raise ``InvalidInput`` where ``possible`` does."""
        if self.possible is not None:
            load(self.possible)(inputs)

    def instant_answer(self, inputs: WireModel) -> dict[str, Any] | None:
        """The document that is known before any engine has run, or None."""
        return None if self.instant is None else load(self.instant)(inputs)
