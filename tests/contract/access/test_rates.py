"""How often a key may ask, and somebody without one guess."""

from __future__ import annotations

from safestart.runtime.access import Role
from safestart_service.access import rates
from safestart_service.access.gate import MOST_FAILURES_PER_S
from safestart_service.access.rates import Buckets
from tests.contract.access.key_holders import ASK, BY, bearer
from tests.contract.api.service_client import HEAVY, assert_problem, service


def test_rates_per_key(tmp_path, monkeypatch):
    monkeypatch.setattr("safestart_service.access.rates.monotonic", lambda: 0.0)
    with service(tmp_path, rate_per_s=0.5, submit_rate_per_s=0.2) as client:
        found = client.app.state.services
        one, two = (found.keys.create(name, Role.SUBMIT, None, BY)[1] for name in ("one", "two"))
        found.keyring.load()
        submitted = [
            client.post("/processes/benchmark/execution", json=HEAVY, headers=bearer(one)) for _ in range(3)
        ]
        assert [answer.status_code for answer in submitted] == [201, 201, 429]
        assert int(submitted[-1].headers["retry-after"]) > 0
        assert assert_problem(submitted[-1], 429)["type"].endswith("rate-limited")
        asked = [client.get("/go-no-go", params=ASK, headers=bearer(one)).status_code for _ in range(4)]
        assert asked == [200, 200, 429, 429]
        assert client.get("/go-no-go", params=ASK, headers=bearer(two)).status_code == 200
        assert client.get("/healthz").status_code == 200


def test_guessing_is_slowed_down_but_shuts_nobody_out(guarded, monkeypatch):
    """On a clock that stands still: a slow machine must not fill the bucket while it asks."""
    client, made, _ = guarded
    now = [0.0]
    monkeypatch.setattr(rates, "monotonic", lambda: now[0])

    def guess() -> int:
        return client.get("/jobs", headers=bearer("guess")).status_code

    burst = round(MOST_FAILURES_PER_S * rates.BURST_S)
    assert [guess() for _ in range(burst + 2)] == [401] * burst + [429] * 2
    assert client.get("/jobs", headers=bearer(made["read"])).status_code == 200
    now[0] = 1.0
    again = round(MOST_FAILURES_PER_S)
    assert [guess() for _ in range(again + 1)] == [401] * again + [429]


def test_buckets_fill_again_and_stay_few(monkeypatch):
    now = [0.0]
    monkeypatch.setattr(rates, "monotonic", lambda: now[0])
    buckets = Buckets(2.0, burst=3.0)
    assert [buckets.take("a") for _ in range(4)] == [True, True, True, False]
    now[0] = 0.5
    assert [buckets.take("a") for _ in range(2)] == [True, False]
    now[0] = 100.0
    assert [buckets.take("a") for _ in range(4)] == [True, True, True, False]
    for i in range(rates.MOST_NAMES + 10):
        buckets.take(str(i))
    assert len(buckets._held) == rates.MOST_NAMES
