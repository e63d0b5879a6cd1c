"""Which call needs which role, with keys and without."""

from __future__ import annotations

import pytest

from safestart.runtime.access import Role
from safestart_service.access.gate import needed_role
from tests.contract.access.key_holders import ASK, bearer
from tests.contract.api.service_client import BASE, HEAVY, POINT, assert_problem, service, submit


def test_without_keys_loopback_is_open(tmp_path):
    with service(tmp_path) as client:
        assert client.get("/go-no-go", params=ASK).status_code == 200
        assert client.get("/go-no-go", params=ASK, headers=bearer("anything")).status_code == 200
        submit(client)
        problem = assert_problem(client.get("/admin/keys"), 401)
        assert "safestart keys create" in problem["detail"]
        assert_problem(client.post("/admin/keys", json={"name": "x", "role": "admin"}), 401)


def test_without_keys_other_addresses_are_refused(tmp_path):
    """Even if something else than ``safestart serve`` binds the application to the network."""
    from starlette.testclient import TestClient

    with service(tmp_path) as client:
        outside = TestClient(client.app, base_url="http://192.0.2.7:8000")
        assert outside.get("/healthz").status_code == 200
        assert_problem(outside.get("/go-no-go", params=ASK), 401)
        assert_problem(outside.post("/processes/benchmark/execution", json=HEAVY), 401)


def test_without_keys_a_proxy_does_not_let_strangers_in(tmp_path):
    """Bound to loopback, behind a proxy that says who asks."""
    from starlette.testclient import TestClient

    with service(tmp_path) as client:
        stranger, neighbour = (
            TestClient(client.app, base_url="http://127.0.0.1:8000", client=(address, 1))
            for address in ("203.0.113.5", "127.0.0.1")
        )
        assert stranger.get("/healthz").status_code == 200
        assert_problem(stranger.get("/jobs"), 401)
        assert_problem(stranger.post("/processes/benchmark/execution", json=HEAVY), 401)
        assert neighbour.get("/jobs").status_code == 200


def test_roles(guarded):
    client, made, _ = guarded
    execution, light = "/processes/benchmark/execution", "/processes/certificate/execution"
    calls = [
        ("read", client.get, "/go-no-go", {"params": ASK}),
        ("read", client.post, "/certificates", {"json": POINT}),
        ("read", client.get, "/jobs", {}),
        ("read", client.get, "/metrics", {}),
        ("submit", client.post, execution, {"json": HEAVY}),
        ("read", client.post, light, {"json": {"inputs": POINT}}),
        ("submit", client.post, light, {"json": {"inputs": POINT}, "headers": {"Prefer": "respond-async"}}),
        ("admin", client.get, "/admin/keys", {}),
        ("admin", client.post, "/admin/keys", {"json": {"name": "new"}}),
        ("admin", client.get, "/admin/audit", {}),
    ]
    ranks = list(Role)
    for needed, call, path, more in calls:
        assert_problem(call(path, **more), 401)
        for role, key in made.items():
            answer = call(path, **{**more, "headers": {**more.get("headers", {}), **bearer(key)}})
            if ranks.index(Role(role)) >= ranks.index(Role(needed)):
                assert answer.status_code in (200, 201), (path, role, answer.text)
            else:
                assert_problem(answer, 403)


def test_every_operation_is_guarded_as_it_says(guarded):
    """No route without a rule: whatever is not public answers 401, and every change is refused to a read key."""
    client, made, _ = guarded
    document = client.app.openapi()
    for path, operations in document["paths"].items():
        concrete = path.replace("{", "").replace("}", "")
        for method, operation in operations.items():
            role = needed_role(method.upper(), concrete)
            assert bool(operation["security"]) == (role is not None)
            assert role is not None or method == "get", "what is public changes nothing"
            bare = client.request(method, concrete, follow_redirects=False)
            assert (bare.status_code == 401) == (role is not None), (method, path)
            if role is not None:
                assert bare.headers["www-authenticate"].startswith("Bearer")
            if role in (Role.SUBMIT, Role.ADMIN):
                assert_problem(client.request(method, concrete, headers=bearer(made["read"])), 403)
            if role is Role.ADMIN:
                assert_problem(client.request(method, concrete, headers=bearer(made["submit"])), 403)
    assert_problem(client.get("/nothing"), 401)
    assert_problem(client.put("/jobs/x"), 401)


@pytest.mark.parametrize("root", ["/behind", "/admin"])
def test_a_mount_path_hides_no_rule(guarded, root):
    from starlette.testclient import TestClient

    client, made, _ = guarded
    mounted = TestClient(client.app, base_url=BASE, root_path=root)
    assert_problem(mounted.get(f"{root}/admin/keys", headers=bearer(made["submit"])), 403)
    assert_problem(mounted.get(f"{root}/jobs"), 401)
    assert mounted.get(f"{root}/jobs", headers=bearer(made["read"])).status_code == 200
