"""Prometheus metrics: requests and latency by route, jobs by status, workers alive."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from math import ceil
from time import perf_counter

from prometheus_client import CollectorRegistry, Counter, Histogram, generate_latest
from prometheus_client.core import CounterMetricFamily, GaugeMetricFamily, Metric
from prometheus_client.registry import Collector
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from safestart.errors import SafestartError
from safestart.store.records import Run, Vitals

BUCKETS = (0.0005, 0.001, 0.0025, 0.005, 0.01, 0.025, 0.05, 0.1, 0.25, 0.5, 1.0, 2.5, 10.0)
UNROUTED = "(none)"

QUANTILES = (0.5, 0.9, 1.0)
TALLIES = {
    "lease_losses": "Jobs taken over because the lease of their worker ran out.",
    "task_deaths": "Task processes that died while they ran a job.",
    "poisoned": "Jobs that failed because every attempt was lost.",
}


class _StoreCollector(Collector):
    """Queries the store at each scrape; an unavailable store shows as ``safestart_store_up 0``."""

    def __init__(self, vitals: Callable[[], Vitals]) -> None:
        self._vitals = vitals

    def collect(self) -> Iterator[Metric]:
        """Yield the gauges of this scrape."""
        up = GaugeMetricFamily("safestart_store_up", "1 when the database answers.")
        try:
            vitals = self._vitals()
        except SafestartError:
            up.add_metric([], 0)
            yield up
            return
        up.add_metric([], 1)
        yield up
        jobs = GaugeMetricFamily("safestart_jobs", "Jobs by status.", labels=["status"])
        for status, count in vitals.jobs.items():
            jobs.add_metric([str(status)], count)
        yield jobs
        crew = vitals.crew
        for name, text, value in (
            ("queue_depth", "Jobs that wait.", vitals.jobs["accepted"]),
            ("queue_oldest_wait_seconds", "Age of the oldest waiting job.", vitals.oldest_wait_s),
            ("workers_alive", "Workers whose heartbeat is fresh.", crew.workers),
            ("places", "Jobs that the living workers can run at once.", crew.places),
            ("places_taken", "Places in which a job runs.", crew.busy),
        ):
            yield GaugeMetricFamily(f"safestart_{name}", text, value=value)
        for name, text in TALLIES.items():
            yield CounterMetricFamily(f"safestart_{name}", text, value=vitals.tallies.get(name, 0))
        yield from _run_times(vitals.runs)


def _run_times(runs: Sequence[Run]) -> Iterator[Metric]:
    """Quantiles over the latest successful jobs, by process."""
    waited = GaugeMetricFamily(
        "safestart_job_wait_seconds", "Time from submission to start.", labels=["process", "quantile"]
    )
    took = GaugeMetricFamily(
        "safestart_job_run_seconds", "Time from start to end.", labels=["process", "quantile"]
    )
    for process in sorted({run.process_id for run in runs}):
        own = [run for run in runs if run.process_id == process]
        for family, values in ((waited, [run.wait_s for run in own]), (took, [run.run_s for run in own])):
            ordered = sorted(values)
            for share in QUANTILES:
                family.add_metric([process, str(share)], ordered[ceil(share * len(ordered)) - 1])
    yield waited
    yield took


class Metrics:
    """One registry per application, so that tests can run several side by side."""

    def __init__(self, vitals: Callable[[], Vitals]) -> None:
        self.registry = CollectorRegistry(auto_describe=False)
        self._requests = Counter(
            "safestart_http_requests",
            "Requests answered.",
            ["method", "route", "status"],
            registry=self.registry,
        )
        self._latency = Histogram(
            "safestart_http_request_seconds",
            "Time to the start of the answer.",
            ["route"],
            buckets=BUCKETS,
            registry=self.registry,
        )
        self.registry.register(_StoreCollector(vitals))
        # Cache the labelled children: looking one up takes longer than updating it.
        self._children: dict[tuple[str, str, int], tuple[Callable[[], None], Callable[[float], None]]] = {}

    def observe(self, method: str, route: str, status: int, seconds: float) -> None:
        """Count one answer."""
        key = (method, route, status)
        child = self._children.get(key)
        if child is None:
            child = (
                self._requests.labels(method, route, str(status)).inc,
                self._latency.labels(route).observe,
            )
            self._children[key] = child
        child[0]()
        child[1](seconds)

    def refused(self, status: int) -> None:
        """Count a refusal from before any route: at the gate, or on the wire."""
        self._requests.labels("*", UNROUTED, str(status)).inc()

    def render(self) -> bytes:
        """The exposition text; queries the database, so call it off the event loop."""
        return generate_latest(self.registry)


class MetricsMiddleware:
    """ASGI middleware that times each request up to the start of its answer."""

    def __init__(self, app: ASGIApp, metrics: Metrics) -> None:
        self.app = app
        self.metrics = metrics

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Serve one request."""
        if scope["type"] != "http":
            await self.app(scope, receive, send)
            return
        start = perf_counter()

        async def send_timed(message: Message) -> None:
            if message["type"] == "http.response.start":
                route = scope.get("route")
                # Use path templates as labels: labels by path would grow without bound.
                path = UNROUTED if route is None else getattr(route, "path", UNROUTED)
                method = scope["method"] if route is not None else "*"
                self.metrics.observe(method, path, message["status"], perf_counter() - start)
            await send(message)

        await self.app(scope, receive, send_timed)
