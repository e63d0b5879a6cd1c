"""GET /go-no-go against a bare FastAPI endpoint that returns a constant document of the same size.

Both run as ``uvicorn`` with uvloop and httptools, one process each, and are loaded in turns (A B A B) from this
process, so that a change of the machine's load meets both.
"""

from __future__ import annotations

import json
import tempfile
import urllib.request
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np

from benchmarks.asked import parser
from benchmarks.load import requests_per_second
from benchmarks.server import answered, server
from safestart.closed_form.certified import certify
from safestart.model.scenario import Scenario

QUESTION = "/go-no-go?omega_t_deg_s=3&a_max_m_s2=0.1&x_m=5&y_m=40"
# A start moves from call to call, the operating point seldom: 8 operating points, 50 starts each.
STARTS = tuple((omega, thrust, x) for omega in (1, 2, 3, 4) for thrust in (0.1, 0.2) for x in range(-25, 25))


def _path(omega: float, thrust: float, x: float) -> str:
    return f"/go-no-go?omega_t_deg_s={omega}&a_max_m_s2={thrust}&x_m={x}&y_m=40"


def _certified(omega: float, thrust: float, x: float) -> bool:
    return bool(certify(Scenario.of(omega, thrust), np.array([x, 40.0])).go)


# Those that the certificate decides, and those for which a cone program must be solved.
QUESTIONS = tuple(_path(*start) for start in STARTS if _certified(*start))
OPEN = tuple(_path(*start) for start in STARTS if not _certified(*start))
# Never the same operating point twice within the service's cache.
FRESH = tuple(
    f"/go-no-go?omega_t_deg_s={1 + k * 1e-4:.4f}&a_max_m_s2=0.1&x_m=5&y_m=40" for k in range(20_000)
)


def measure(seconds: float = 2.0, repeats: int = 5) -> dict[str, Any]:
    """Requests per second of both, and the median of the pairwise ratios.

    ``ratio`` is against FastAPI's ordinary endpoint, ``ratio_encoded`` against one that sends prepared bytes;
    ``ratio_fresh`` is against the ordinary one when every question has another operating point; ``ratio_keyed`` when
    API keys are in use and each request brings one. All these are decided by the certificate; ``rps_exact`` are the
    requests per second of starts that it leaves to a cone program.
    """
    with tempfile.TemporaryDirectory() as folder:
        url = f"sqlite:///{Path(folder) / 'bench.sqlite3'}"
        keyed_url = f"sqlite:///{Path(folder) / 'keyed.sqlite3'}"
        key = _key(keyed_url)
        with (
            server(
                "safestart_service.app:create_app",
                "/healthz",
                SAFESTART_DATABASE_URL=url,
                # Otherwise a helper process that starts late is ended with its first answer, and begins anew.
                SAFESTART_ANSWER_TIMEOUT_S="600",
            ) as ours,
            server(
                "safestart_service.app:create_app",
                "/healthz",
                SAFESTART_DATABASE_URL=keyed_url,
                SAFESTART_RATE_PER_S="1e9",
            ) as keyed,
        ):
            with urllib.request.urlopen(f"http://127.0.0.1:{ours}{QUESTION}") as answer:
                document = json.loads(answer.read())
            peer = server(
                "benchmarks.peers.constant_service:app", "/encoded", CONSTANT_DOCUMENT=json.dumps(document)
            )
            with peer as bare:
                return _compare(ours, bare, keyed, key, seconds, repeats)


def _key(url: str) -> str:
    """Make a key with role read, in a separate database."""
    from safestart.runtime.access import Caller, Role
    from safestart.store.access.keys import KeyRepository
    from safestart.store.database import Database

    database = Database(url)
    database.migrate()
    _, key = KeyRepository(database).create("bench", Role.READ, None, Caller(None, "bench", Role.ADMIN))
    database.close()
    return key


def _compare(ours: int, bare: int, keyed: int, key: str, seconds: float, repeats: int) -> dict[str, Any]:
    calls: dict[str, tuple[int, tuple[str, ...], str]] = {
        "service": (ours, QUESTIONS, ""),
        "exact": (ours, OPEN, ""),
        "bare": (bare, ("/constant",), ""),
        "encoded": (bare, ("/encoded",), ""),
        "fresh": (ours, FRESH, ""),
        "keyed": (keyed, QUESTIONS, f"Authorization: Bearer {key}\r\n"),
    }
    rates: dict[str, list[float]] = {name: [] for name in calls}
    # What the certificate leaves open goes to a helper process, which loads for a minute on a busy machine.
    answered(ours, OPEN[0])
    for port, paths, more in calls.values():
        requests_per_second(port, paths, 0.5, more=more)  # warm up
    for _ in range(repeats):
        for name, (port, paths, more) in calls.items():
            rates[name].append(requests_per_second(port, paths, seconds, more=more))

    def ratio(peer: str, service: str = "service") -> float:
        return median(a / b for a, b in zip(rates[service], rates[peer], strict=True))

    return {
        "ratio": ratio("bare"),
        "ratio_encoded": ratio("encoded"),
        "ratio_fresh": ratio("bare", "fresh"),
        "ratio_keyed": ratio("bare", "keyed"),
        "rps_service": median(rates["service"]),
        "rps_exact": median(rates["exact"]),
        "rps_bare": median(rates["bare"]),
        "rps_encoded": median(rates["encoded"]),
        "repeats": repeats,
        "seconds": seconds,
        "ratios": {"go_no_go_rps": ratio("bare")},
        "times": {},
    }


if __name__ == "__main__":
    parser(__doc__).parse_args()
    print(json.dumps(measure(), indent=2))
