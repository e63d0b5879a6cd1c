"""The API's answers at once, over an in-process client: one verdict however it is asked."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from safestart.closed_form.paper import certify, range_limit
from safestart.model.scenario import Chaser, CorridorShape, Rest, Scenario, Target
from safestart.proofs.checker import check
from tests.contract.api.service_client import (
    POINT,
)


def test_go_no_go_single(client):
    answer = client.get("/go-no-go", params={**POINT, "x_m": 5, "y_m": 40, "method": "paper"})
    assert answer.status_code == 200
    body = answer.json()
    assert body["verdict"] == "GO"
    assert body["r_sync_m"] == pytest.approx(72.9513, abs=1e-4)
    assert set(body["face_margins_m"]) == {"hold_plane", "right", "left"}
    assert body["margin_m"] == min(*body["face_margins_m"].values(), body["range_margin_m"])
    assert (body["method"], body["decided_by"]) == ("paper", "paper")


def test_the_default_is_no_go_without_a_proof(client):
    """Certified at once and for ever, or proved by a program; the document of a proof is one call away."""
    near = client.get("/go-no-go", params={**POINT, "x_m": 5, "y_m": 40}).json()
    assert (near["verdict"], near["method"], near["decided_by"]) == ("GO", "auto", "certified")
    same = client.get("/go-no-go", params={**POINT, "x_m": 5, "y_m": 40, "method": "certified"}).json()
    assert same["margin_m"] == near["margin_m"] > 0.0
    proof = client.get(near["proof_url"]).json()
    assert check(proof).verdict == "GO"
    assert proof["start"]["position_m"] == [5.0, 40.0]
    by_hand = {**POINT, "x_m": 9, "y_m": 69}
    paper = client.get("/go-no-go", params={**by_hand, "method": "paper"}).json()
    open_ = client.get("/go-no-go", params={**by_hand, "method": "certified"}).json()
    found = client.get("/go-no-go", params=by_hand).json()
    assert (paper["verdict"], open_["verdict"], open_["decided_by"]) == ("GO", "UNDECIDED", None)
    assert found["decided_by"] == "exact"
    assert check(client.get(found["proof_url"]).json()).verdict == found["verdict"]
    more = {**POINT, "x_m": 5, "y_m": 40}
    for question in ({"question": "synchronize"}, {"speed_limit_m_s": 3}, {"keep_out_m": 0.2}):
        assert client.get("/go-no-go", params=more | question).json()["decided_by"] == "exact"
    spread = client.get("/go-no-go", params=more | {"position_half_width_m": 0.1}).json()
    assert (spread["verdict"], spread["decided_by"]) == ("GO", "families")
    pushed = client.get("/go-no-go", params=more | {"disturbance_m_s2": 0.001}).json()
    assert (pushed["verdict"], pushed["decided_by"]) == ("GO", "tube")


def test_many_starts_are_each_decided_by_the_first_that_can(client):
    states = [{"x_m": 9, "y_m": 69}, {"x_m": 5, "y_m": 40}, {"x_m": 90, "y_m": 10}, {"x_m": 0, "y_m": 20}]
    body = client.post("/go-no-go", json={**POINT, "states": states}).json()
    assert body["decided_by"] == ["exact", "certified", "exact", "certified"]
    alone = [client.get("/go-no-go", params={**POINT, **state}).json() for state in states]
    for name in ("verdict", "margin_m", "reason", "decided_by"):
        assert body[name] == [one[name] for one in alone]
    many = client.post("/go-no-go", json={**POINT, "states": states * 60}).json()
    assert many["verdict"] == body["verdict"] * 60
    assert set(many["decided_by"]) == {"certified", "atlas"}


def test_no_tumble_has_no_range_limit(client):
    body = client.get("/go-no-go", params={"omega_t_deg_s": 0, "a_max_m_s2": 0.1, "x_m": 0, "y_m": 90}).json()
    assert body["verdict"] == "GO"
    assert body["r_sync_m"] is None
    assert body["range_margin_m"] is None
    assert "does not tumble" in body["r_sync_reason"]


def test_outside_the_corridor_is_an_answer(client):
    body = client.get("/go-no-go", params={**POINT, "x_m": 90, "y_m": 10}).json()
    assert body["verdict"] == "NO_GO"
    assert body["violated_faces"] == ["right"]


coordinate = st.one_of(
    st.floats(-200, 200), st.floats(-10_000, 10_000), st.sampled_from([0.0, 0.5, 2.5, -2.5])
)


@settings(max_examples=150, suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow])
@given(
    omega=st.one_of(st.just(0.0), st.floats(1e-6, 60.0)),
    thrust=st.floats(1e-4, 10.0),
    x=coordinate,
    y=coordinate,
    z=st.none() | coordinate,
    rest=st.sampled_from(list(Rest)),
    shape=st.just((1.5, 1.5, 2.5, 2.5, 0.5))
    | st.tuples(
        st.floats(0.01, 100), st.floats(0.01, 100), st.floats(0, 50), st.floats(0, 50), st.floats(0, 50)
    ),
)
def test_single_answer_is_the_certificate(client, omega, thrust, x, y, z, rest, shape):
    """The paper's conditions by GET in plain floats, in NumPy, by POST for one and two: the same to the last bit."""
    query = {
        "method": "paper",
        "omega_t_deg_s": omega,
        "a_max_m_s2": thrust,
        "x_m": x,
        "y_m": y,
        "rest": rest.value,
    }
    query |= dict(zip(("c_x", "c_z", "x0_m", "z0_m", "r_h_m"), shape, strict=True))
    if z is not None:
        query["z_m"] = z
    answer = client.get(
        "/go-no-go", params={name: repr(v) if isinstance(v, float) else v for name, v in query.items()}
    )
    assert answer.status_code == 200, answer.text
    body = answer.json()

    scenario = Scenario(Target(math.radians(omega)), Chaser(thrust), CorridorShape(*shape))
    point = [x, y] if z is None else [x, y, z]
    certificate = certify(scenario, np.array([point, [1.0] * len(point)]), rest)
    assert body["verdict"] == ("GO" if certificate.safe[0] else "NO_GO")
    assert body["margin_m"] == certificate.margin[0]
    assert list(body["face_margins_m"].values()) == certificate.face_margin[0].tolist()
    limit = range_limit(scenario, rest)
    assert body["r_sync_m"] == (limit if math.isfinite(limit) else None)
    assert body["violated_faces"] == [
        face for face, slack in zip(certificate.faces, certificate.slack[0], strict=True) if slack < 0.0
    ]

    inputs = {name: query[name] for name in ("omega_t_deg_s", "a_max_m_s2", "rest", "method")}
    inputs["corridor"] = {name: query[name] for name in ("c_x", "c_z", "x0_m", "z0_m", "r_h_m")}
    state = {name: query[name] for name in ("x_m", "y_m", "z_m") if name in query}
    for states in ([state], [state, dict.fromkeys(state, 1.0)]):
        many = client.post("/go-no-go", json=inputs | {"states": states}).json()
        assert first(many) == body


def first(many):
    """The answer on the first of many starts, in the form that an answer on one has."""
    flat = {
        name: value[0] if isinstance(value, list) else value
        for name, value in many.items()
        if name != "faces"
    }
    return flat | {"face_margins_m": dict(zip(many["faces"], many["face_margins_m"][0], strict=True))}


def test_go_no_go_many(client):
    states = [{"x_m": x, "y_m": 40} for x in range(-60, 61)]
    body = client.post("/go-no-go", json={**POINT, "states": states}).json()
    assert len(body["verdict"]) == len(states)
    for state, verdict in zip(states[::20], body["verdict"][::20], strict=True):
        assert client.get("/go-no-go", params={**POINT, **state}).json()["verdict"] == verdict


def test_hundred_thousand_states(client):
    rows = ",".join(f'{{"x_m":{i % 50},"y_m":{i % 150}}}' for i in range(100_000))
    body = f'{{"omega_t_deg_s":3,"a_max_m_s2":0.1,"states":[{rows}]}}'
    answer = client.post("/go-no-go", content=body, headers={"Content-Type": "application/json"})
    assert answer.status_code == 200
    assert len(answer.json()["verdict"]) == 100_000


def test_certificates(client):
    body = client.post("/certificates", json={**POINT, "grid": {"nx": 31, "ny": 31, "y_max_m": 150}}).json()
    assert body["r_sync_m"] == pytest.approx(72.9513, abs=1e-4)
    assert np.array(body["mask"]).shape == np.array(body["margin_m"]).shape == (31, 31)
    assert 0 < body["safe_fraction"] < 1
