"""What JSON has not, and numbers beyond a double: the refusal says which of them came, in bodies and in queries."""

from __future__ import annotations

from typing import Any

import pytest

from tests.contract.api.service_client import POINT, assert_problem

SPACE = {"omega_t_deg_s": 3, "a_max_m_s2": 0.1, "position_m": "[2,25,0]"}


@pytest.mark.parametrize(
    ("name", "text", "said"),
    [
        ("attitude", '{"kind":"spin","kind":"spin"}', "kind comes twice"),
        ("position_m", "[2,25,NaN]", "JSON has no NaN"),
        ("position_m", "[2,-Infinity,0]", "JSON has no NaN and no Infinity"),
        ("position_m", "[2,25,1e400]", "a double can hold"),
        ("omega_t_deg_s", "1e400", "a double can hold"),
        ("omega_t_deg_s", "inf", "a finite number"),
        ("position_m", "[2,", "required JSON"),
    ],
)
def test_a_query_says_what_is_wrong(client: Any, name: str, text: str, said: str) -> None:
    problem = assert_problem(client.get("/go-no-go", params=SPACE | {name: text}), 422, name)
    assert said in problem["detail"]
    assert "received inf" not in problem["detail"].replace("received 'inf'", "")


@pytest.mark.parametrize(
    ("number", "shown"), [("1e400", "received 1e400"), ("-1.5E999", "received -1.5E999")]
)
@pytest.mark.parametrize("path", ["/certificates", "/processes/certificate/execution"])
def test_a_body_says_what_is_wrong(client: Any, path: str, number: str, shown: str) -> None:
    inputs = f'{{"omega_t_deg_s": {number}, "a_max_m_s2": {POINT["a_max_m_s2"]}}}'
    body = inputs if path == "/certificates" else f'{{"inputs": {inputs}}}'
    problem = assert_problem(
        client.post(path, content=body, headers={"Content-Type": "application/json"}), 422, "omega_t_deg_s"
    )
    assert "a double can hold" in problem["required"]
    assert shown in problem["detail"]
