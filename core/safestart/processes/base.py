"""A process: a description with typed inputs and outputs, and a pure function of (inputs, context)."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Any

from pydantic import ValidationError
from pydantic_core import PydanticSerializationError, to_json

from safestart.errors import UnfitResult
from safestart.model.strict_json import validated_values
from safestart.model.validation import differs_by_version, error_of, validation_error
from safestart.model.wire_model import WireModel as WireModel
from safestart.processes.output import ProcessOutput as ProcessOutput
from safestart.processes.sharding import Sharding
from safestart.processes.views import View
from safestart.processes.views.fitting import Shown
from safestart.records.artifact import Artifact as Artifact
from safestart.runtime.named import load, misregistered
from safestart.runtime.progress import Context

Runner = Callable[[Any, Context], ProcessOutput]
_ID = re.compile(r"[a-z][a-z0-9]*(-[a-z0-9]+)*")


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
    parts of :mod:`safestart.runtime.kernels.warmup` that its jobs need: a worker that
    has just started compiles those of waiting jobs first. ``at_once`` names a function (inputs, context) ->
    ``ProcessOutput`` or None: the output where a dear question turns out to be cheap, as the service can tell without
    the libraries that the process needs. ``parts`` names a function (inputs, context) -> pairs of name and value, the
    members of the document, for those that take much memory; large numeric ones may be arrays. ``tables`` declares
    tables over plain lists among the outputs; lists of objects are tables without a declaration. ``views`` say how a
    page shows the outputs, the most important first. ``courses`` names a function (inputs, outputs) ->
    ``FlightCourses`` or None where the outputs are a flight: the service then offers it as CCSDS messages and CZML.
    ``extensions`` are further members of its description, named ``safestart:...``.
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
    at_once: str | None = None
    parts: str | None = None
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

    def __post_init__(self) -> None:
        """Raise ``Misregistered`` for a process that could not run, or that could not be shown."""
        if not _ID.fullmatch(self.id):
            raise misregistered("id of a process", "small letters, digits and single hyphens", self.id)
        if not self.run and self.sharding is None:
            raise misregistered(f"process {self.id}", "run or sharding", self.run)
        engines = tuple(one["name"] for one in self.extensions.get("safestart:engines", ()))
        Shown(self.inputs, self.outputs, self.tables, engines).require(self.id, self.views)

    def parse(self, inputs: Any) -> WireModel:
        """Validate what somebody asks, strictly and as a POST does (:mod:`safestart.model.strict_json`).

        Raises ``InvalidInput`` naming the first field, what it requires, what came. Inputs that are validated already
        are returned.
        """
        return inputs if isinstance(inputs, self.inputs) else validated_values(self.inputs, inputs)

    def stored(self, inputs: Any) -> WireModel:
        """Inputs that were validated when they were stored: what an earlier version accepted still runs.

        Raises ``InvalidInput`` for those of a process that has changed.
        """
        try:
            return self.inputs.model_validate(inputs)
        except ValidationError as error:
            raise validation_error(error, model=self.inputs) from None

    def check(self, document: dict[str, Any], *, another_version: bool = False) -> None:
        """Raise ``UnfitResult`` unless ``document``, in its stored JSON form, matches ``outputs``.

        Nothing is converted: text is not accepted as a number, 2.0 not as an integer, and NaN is refused. Outputs of
        ``another_version`` may have fields more or fewer, other words and other bounds, but no other kinds of values.
        """
        try:
            self.outputs.model_validate_json(to_json(document, inf_nan_mode="constants"), strict=True)
        except ValidationError as error:
            reports: list[Any] = error.errors(include_url=False)
            if another_version:
                reports = [one for one in reports if not differs_by_version(one)]
            if reports:
                raise error_of(UnfitResult, reports, "outputs.") from None
        except PydanticSerializationError as error:
            raise UnfitResult(
                f"outputs: required JSON, received something else ({error})", required="JSON"
            ) from None

    def runner(self) -> Runner:
        """Import and return the function that executes this process."""
        if self.sharding is None:
            runner: Runner = load(self.run, f"run of process {self.id}")
            return runner
        load(self.sharding.shard, f"shard of process {self.id}")
        load(self.sharding.merge, f"merge of process {self.id}")
        return self.sharding.run

    def require_possible(self, inputs: WireModel) -> None:
        """Raise ``InvalidInput`` where ``possible`` does."""
        if self.possible is not None:
            load(self.possible, f"possible of process {self.id}")(inputs)

    def output_at_once(self, inputs: WireModel, context: Context) -> dict[str, Any] | None:
        """The output document of a question that turns out to be cheap, else None."""
        if self.at_once is None:
            return None
        found: ProcessOutput | None = load(self.at_once, f"at_once of process {self.id}")(inputs, context)
        return None if found is None else found.document

    def output_parts(self, inputs: WireModel, context: Context) -> Iterator[tuple[str, Any]]:
        """Name and value of every output of a light process; where it has ``parts``, a list may be an array."""
        if self.parts is None:
            return iter(self.runner()(inputs, context).document.items())
        found: Iterator[tuple[str, Any]] = load(self.parts, f"parts of process {self.id}")(inputs, context)
        return found

    def instant_answer(self, inputs: WireModel) -> dict[str, Any] | None:
        """The document that is known before any engine has run, or None."""
        if self.instant is None:
            return None
        found: dict[str, Any] = load(self.instant, f"instant of process {self.id}")(inputs)
        return found
