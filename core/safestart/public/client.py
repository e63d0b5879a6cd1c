"""`Client`: the same calls, answered by a service."""

from __future__ import annotations

import uuid
from collections.abc import Iterable, Iterator, Mapping
from typing import TYPE_CHECKING, Any
from urllib.parse import quote

import numpy as np

from safestart.errors import Unavailable
from safestart.model.scenario import MAX_RANGE, Rest, Scenario, number
from safestart.processes.go_no_go.question_fields import AfterArrival
from safestart.public.certificates import Certificates
from safestart.public.decisions import Asked, Decision, asked_of
from safestart.public.flights import Flight
from safestart.public.following import followed
from safestart.public.proofs import verify
from safestart.public.regions import Region
from safestart.public.results import Result
from safestart.public.starts import point_of, points_of, rest_of, seconds, state_of, wire_of
from safestart.public.wire import TIMEOUT_S, Wire, artifact_of, sent
from safestart.records.labels import labels_of

if TYPE_CHECKING:
    import os
    from types import TracebackType

    import httpx
    from numpy.typing import ArrayLike

    from safestart.proofs.single import Verified

_AT_ONCE = 10_000


class Client:
    """A service at ``url``; calls take the arguments of the functions of the same name and return the same results.

    ``key`` is an API key, if the service requires one. The tumble rate travels in degrees, which changes the last bit
    of a few rates. Proofs are checked here, so you need not trust the service. Errors of the service raise the matching
    exception, ``Unavailable`` when it does not answer. Close it, or use it in a ``with`` block.
    """

    def __init__(
        self,
        url: str,
        key: str | None = None,
        *,
        timeout_s: float = TIMEOUT_S,
        http: httpx.Client | None = None,
    ) -> None:
        self._wire = Wire(url, key, timeout_s, http)

    def __enter__(self) -> Client:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def close(self) -> None:
        """Close the connections."""
        self._wire.close()

    def certify(self, scenario: Scenario, points: ArrayLike, rest: Rest | str = Rest.LVLH) -> Certificates:
        """As `safestart.certify`, for planar or for spatial points."""
        given, rest = points_of(points), rest_of(rest)
        flat = given.reshape(-1, given.shape[-1])
        verdicts: list[str] = []
        margins: list[float] = []
        for first in range(0, len(flat), _AT_ONCE):
            states = [state_of(point) for point in flat[first : first + _AT_ONCE]]
            asked = {**wire_of(scenario), "states": states, "rest": rest.value, "method": "certified"}
            found = self._wire.post("/go-no-go", asked)
            verdicts += found["verdict"]
            margins += [np.nan if margin is None else margin for margin in found["margin_m"]]
        shape = given.shape[:-1]
        return Certificates(
            scenario,
            given,
            rest,
            np.array(verdicts, dtype=np.str_).reshape(shape),
            np.array(margins, dtype=np.float64).reshape(shape),
        )

    def decide(
        self,
        scenario: Scenario,
        start: ArrayLike,
        rest: Rest | str = Rest.LVLH,
        *,
        question: Asked = "stay",
        horizon_s: float = 60.0,
        within_s: float = 200.0,
        after_arrival: AfterArrival = "stay",
    ) -> Decision:
        """As `safestart.decide`."""
        point, rest = point_of(start), rest_of(rest)
        asked_of(question, horizon_s, within_s)
        asked = {
            **wire_of(scenario),
            "states": [state_of(point)],
            "rest": rest.value,
            "method": "exact",
            "proofs": True,
            "question": question,
            "horizon_s": horizon_s,
            "within_s": within_s,
            "after_arrival": after_arrival,
        }
        found = self._wire.post("/go-no-go", asked)
        (verdict,), (margin,), (reason,) = found["verdict"], found["margin_m"], found["reason"]
        proof = (found.get("proof") or [None])[0]
        decided = verdict != "UNDECIDED" and margin is not None
        return Decision(scenario, point, rest, verdict, margin if decided else float("nan"), reason, proof)

    def region(self, scenario: Scenario, *, horizon_s: float = 60.0, y_max_m: float = 150.0) -> Region:
        """As `safestart.region`."""
        horizon_s = seconds("horizon_s", horizon_s)
        y_max_m = number("y_max_m", y_max_m, scenario.corridor.hold_radius, MAX_RANGE / 2, open_low=True)
        asked = {**wire_of(scenario), "horizon_s": horizon_s, "y_max_m": y_max_m}
        return Region.of(scenario, horizon_s, y_max_m, self._at_once("safe-region", asked))

    def fly(
        self,
        scenario: Scenario,
        start: ArrayLike,
        rest: Rest | str = Rest.LVLH,
        *,
        question: Asked = "stay",
        horizon_s: float = 60.0,
        within_s: float = 200.0,
    ) -> Flight:
        """As `safestart.fly` without a controller: the thrust history of the largest margin."""
        asked_of(question, horizon_s, within_s)
        asked = {
            **wire_of(scenario),
            "start": state_of(point_of(start)),
            "rest": rest_of(rest).value,
            "question": question,
            "horizon_s": horizon_s,
            "within_s": within_s,
        }
        return Flight.of(scenario, self._at_once("flight", asked))

    def run(
        self,
        process_id: str,
        inputs: Mapping[str, Any] | None = None,
        *,
        progress: bool = True,
        limit_s: float | None = None,
    ) -> Result:
        """Queue a process, follow it, fetch its result and its files.

        Raises ``JobFailed`` with the reason if it fails, ``Unavailable`` if it has not ended after ``limit_s`` seconds;
        the job then continues, and :meth:`result` fetches its result.
        """
        return self.result(self.submit(process_id, inputs), progress=progress, limit_s=limit_s)

    def submit(
        self,
        process_id: str,
        inputs: Mapping[str, Any] | None = None,
        *,
        name: str = "",
        tags: Iterable[str] = (),
        note: str = "",
    ) -> str:
        """Queue a process; returns the id of its job. ``name``, ``tags`` and ``note`` are for people to find it by.

        A name has at most 100 letters, a note 2000; there may be 10 tags of 40 letters.
        """
        path = f"/processes/{quote(process_id, safe='')}/execution"
        headers = {"Prefer": "respond-async", "Idempotency-Key": str(uuid.uuid4())}
        body = {"inputs": sent(inputs), **labels_of(name=name, tags=tags, note=note)}
        job = self._wire.post(path, body, headers, again=True)
        return str(job["jobID"])

    def label(
        self, job: str, *, name: str | None = None, tags: Iterable[str] | None = None, note: str | None = None
    ) -> None:
        """Write the given ones of name, tags and note on a job; raises ``NotFound`` for an unknown one."""
        told = labels_of(name=name, tags=tags, note=note)
        self._wire.answered("PATCH", f"/jobs/{quote(job, safe='')}", told, None, again=True)

    def result(self, job: str, *, progress: bool = True, limit_s: float | None = None) -> Result:
        """The result of a job, followed to its end; raises as :meth:`run`, and ``NotFound`` for an unknown job."""
        place = f"/jobs/{quote(job, safe='')}"
        process_id = followed(self._wire, place, progress=progress, limit_s=limit_s)
        document = self._wire.get(f"{place}/results")
        files = tuple(artifact_of(self._wire, place, entry) for entry in document.get("artifacts", ()))
        return Result(process_id, document, files)

    def verify(self, proof: Mapping[str, Any] | str | os.PathLike[str]) -> Verified:
        """`safestart.verify`: a proof is checked here, not by the service."""
        return verify(proof)

    def processes(self) -> dict[str, str]:
        """The processes of the service: ids with their titles."""
        return dict(self._listed())

    def _listed(self) -> Iterator[tuple[str, str]]:
        for entry in self._wire.get("/processes?limit=1000")["processes"]:
            yield entry["id"], entry["title"]

    def _at_once(self, process_id: str, inputs: dict[str, Any]) -> dict[str, Any]:
        found = self._wire.post(f"/processes/{process_id}/execution", {"inputs": inputs})
        if "jobID" in found:
            raise Unavailable(
                f"{process_id}: required an answer at once, the service queued job {found['jobID']}"
            )
        return found
