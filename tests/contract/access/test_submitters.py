"""Jobs know who submitted them: own jobs, own idempotency keys, priorities, the audit log."""

from __future__ import annotations

from safestart.runtime.access import LOCAL, Role
from tests.contract.access.key_holders import BY, bearer
from tests.contract.api.service_client import HEAVY, assert_problem, service, submit


def test_submitter_dismissal_and_audit(guarded):
    client, made, found = guarded
    other, key = found.keys.create("other", Role.SUBMIT, 1.0, BY)
    found.keyring.load()
    headers = {**bearer(made["submit"]), "X-Request-ID": "trace-9"}
    mine = client.post("/processes/benchmark/execution", json=HEAVY, headers=headers).json()
    ids = {record.name: record.id for record in found.keys.list()}
    assert mine["submitter"] == ids["submit"]
    path = f"/jobs/{mine['jobID']}"
    assert_problem(client.delete(path, headers=bearer(key)), 403, "jobID")
    assert_problem(client.delete(path, headers=bearer(made["read"])), 403)
    assert client.delete(path, headers=bearer(made["submit"])).json()["status"] == "dismissed"
    theirs = client.post("/processes/benchmark/execution", json=HEAVY, headers=bearer(key)).json()["jobID"]
    assert client.delete(f"/jobs/{theirs}", headers=bearer(made["admin"])).status_code == 200

    log = client.get("/admin/audit", headers=bearer(made["admin"])).json()["entries"]
    deeds = [(entry["action"], entry["subject"], entry["key_id"], entry["actor"]) for entry in log[:4]]
    assert deeds == [
        ("dismiss", theirs, ids["admin"], "admin"),
        ("submit", theirs, other.id, "other"),
        ("dismiss", mine["jobID"], ids["submit"], "submit"),
        ("submit", mine["jobID"], ids["submit"], "submit"),
    ]
    assert log[3]["request_id"] == "trace-9"
    assert log[3]["address"] == "127.0.0.1"
    about = client.get(f"/admin/audit?subject={theirs}&limit=1", headers=bearer(made["admin"])).json()
    assert [entry["action"] for entry in about["entries"]] == ["dismiss"]
    rest = client.get(
        f"/admin/audit?subject={theirs}&before={about['next_before']}", headers=bearer(made["admin"])
    )
    assert [entry["action"] for entry in rest.json()["entries"]] == ["submit"]


def test_refused_deeds_are_not_in_the_log(guarded):
    """The log has only real actions: a repeated submission and a repeated dismissal did nothing."""
    client, made, found = guarded
    headers = {**bearer(made["submit"]), "Idempotency-Key": "k"}
    first = client.post("/processes/benchmark/execution", json=HEAVY, headers=headers).json()["jobID"]
    assert client.post("/processes/benchmark/execution", json=HEAVY, headers=headers).json()["jobID"] == first
    for _ in range(2):
        assert client.delete(f"/jobs/{first}", headers=headers).status_code == 200
    actions = [entry.action for entry in found.audit.entries(subject=first).entries]
    assert actions == ["dismiss", "submit"]


def test_only_an_admin_key_goes_ahead_of_others(guarded):
    client, made, found = guarded
    path = "/processes/benchmark/execution"

    def ask(role, priority):
        return client.post(path, json={**HEAVY, "priority": priority}, headers=bearer(made[role]))

    assert_problem(ask("submit", 1), 403, "priority")
    assert_problem(ask("submit", 101), 422, "priority")
    low, usual, high = (ask(*how).json() for how in (("submit", -5), ("submit", 0), ("admin", 5)))
    places = found.jobs.positions(job["jobID"] for job in (low, usual, high))
    assert [places[job["jobID"]] for job in (high, usual, low)] == [1, 2, 3]
    assert (low["priority"], high["priority"]) == (-5, 5)


def test_idempotency_keys_are_each_submitters_own(guarded):
    client, made, found = guarded
    key = found.keys.create("other", Role.SUBMIT, 1.0, BY)[1]
    found.keyring.load()
    made_jobs = {
        client.post(
            "/processes/benchmark/execution", json=HEAVY, headers={**bearer(who), "Idempotency-Key": "run-1"}
        ).json()["jobID"]
        for who in (made["submit"], key, made["submit"], key)
    }
    assert len(made_jobs) == 2


def test_submissions_without_keys_are_audited_too(tmp_path):
    with service(tmp_path) as client:
        job = submit(client)
        client.delete(f"/jobs/{job}")
        entries = client.app.state.services.audit.entries().entries
    assert [(entry.action, entry.key_id, entry.actor) for entry in entries] == [
        ("dismiss", None, LOCAL.name),
        ("submit", None, LOCAL.name),
    ]
