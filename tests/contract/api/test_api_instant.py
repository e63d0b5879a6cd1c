"""The API's answers at once, over an in-process client: one verdict however it is asked."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from safestart.closed_form.paper import certify, range_limit
from safestart.model.scenario import Chaser, CorridorShape, Rest, Scenario, Target
from tests.contract.api.service_client import (
    POINT,
)


def test_go_no_go_single(client):
    answer = client.get("/go-no-go", params={**POINT, "x_m": 5, "y_m": 40})
    assert answer.status_code == 200
    body = answer.json()
    assert body["verdict"] == "GO"
    assert body["r_sync_m"] == pytest.approx(72.9513, abs=1e-4)
    assert set(body["face_margins_m"]) == {"hold_plane", "right", "left"}
    assert body["margin_m"] == min(*body["face_margins_m"].values(), body["range_margin_m"])
    assert body["method"] == "closed_form"


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
    """GET in plain floats, certify in NumPy, POST for one and for two: one answer, to the last bit."""
    query = {"omega_t_deg_s": omega, "a_max_m_s2": thrust, "x_m": x, "y_m": y, "rest": rest.value}
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

    inputs = {name: query[name] for name in ("omega_t_deg_s", "a_max_m_s2", "rest")}
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
