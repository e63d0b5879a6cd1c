"""Questions to a copy of the packages: ``python -m tests.contract.extending.asked FOLDER`` prints the answers."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

from typer.testing import CliRunner

import safestart
import safestart_service
from safestart.cli import build
from safestart.processes.execute import execute
from tests.contract.api.service_client import POINT, jobs_of, service
from tests.waiting import until

if TYPE_CHECKING:
    from starlette.testclient import TestClient

START = {"x_m": 5, "y_m": 40}


def process(client: TestClient, folder: Path) -> dict[str, Any]:
    """The process `drift` on the command line, at once over HTTP, as a job, in the descriptions, as a table."""
    inputs = {"position_m": [0, 100, 0], "velocity_m_s": [0, -0.2, 0], "mean_motion_rad_s": 0}
    written = folder / "inputs.json"
    written.write_text(json.dumps(inputs))
    where = "/processes/drift/execution"
    job = _done(client, folder, where, inputs)
    refused = client.post(where, json={"inputs": {"position_m": [0, 100]}})
    return {
        "printed": _command("run", "drift", "--input", str(written), "--json")["outputs"],
        "at_once": client.post(where, json={"inputs": inputs}).json(),
        "table": client.get(f"/jobs/{job}/results", params={"format": "csv"}).text,
        "refused": [refused.status_code, refused.json()["field"]],
        "description": client.get("/processes/drift").json(),
        "listed": [one["id"] for one in client.get("/processes").json()["processes"]],
        "schemas": [
            name
            for name in client.get("/openapi.json").json()["components"]["schemas"]
            if name.startswith(("Drift", "ExecuteDrift"))
        ],
    }


def method(client: TestClient, _: Path) -> dict[str, Any]:
    """The method `reserve` on the command line, by GET, by POST, and in the description."""
    options = [f"--{name.replace('_', '-')}={value}" for name, value in (POINT | START).items()]
    query = POINT | START | {"method": "reserve"}
    many = POINT | {"states": [START, START], "method": "reserve"}
    return {
        "printed": _command("go-no-go", *options, "--method=reserve", "--json"),
        "one": client.get("/go-no-go", params=query).json(),
        "many": client.post("/go-no-go", json=many).json(),
        "paper": client.get("/go-no-go", params=POINT | START | {"method": "paper"}).json(),
        "proof": client.get("/go-no-go/proof", params=query).json()["schema"],
        "refused": client.get("/go-no-go", params=query | {"method": "none"}).json()["required"],
        "parameter": _parameter(client, "/go-no-go", "method"),
    }


def controller(client: TestClient, folder: Path) -> dict[str, Any]:
    """The controller `damper` flown by a sweep of four starts for 10 s, in the description and in its views."""
    inputs = {"controllers": ["damper"], "certificates": ["paper"], "omega_t_deg_s": [1], "a_max_m_s2": [0.1]}
    written = folder / "sweep.json"
    written.write_text(json.dumps(inputs | {"r0_m": [50], "cases_per_cell": 4, "horizon_s": 10}))
    described = client.get("/processes/sweep").json()
    return {
        "outputs": _command("run", "sweep", "--input", str(written), "--json")["outputs"],
        "offered": described["inputs"]["controllers"]["schema"]
        | {"description": described["inputs"]["controllers"]["description"]},
        "columns": [
            column["title"] for view in described["safestart:views"] for column in view.get("columns", ())
        ],
    }


def motion(client: TestClient, folder: Path) -> dict[str, Any]:
    """The motion `straight` flown by a sweep of four starts and by `fly`, and in the description."""
    world = {"truth": {"model": "straight"}, "mean_motion_rad_s": 0}
    written = folder / "straight.json"
    few = {"omega_t_deg_s": [1], "a_max_m_s2": [0.1], "r0_m": [50], "cases_per_cell": 4, "horizon_s": 10}
    written.write_text(json.dumps(few | world | {"controllers": ["damper"], "certificates": ["paper"]}))
    schema = client.get("/processes/sweep").json()["inputs"]["truth"]["schema"]["properties"]["model"]
    scenario = safestart.Scenario.of(0.0, 0.1)
    flown = safestart.fly(scenario, (5.0, 40.0, 0.0), Coasting(), motion="straight", horizon_s=10.0)
    return {
        "offered": schema["enum"],
        "description": schema["description"],
        "notes": _command("run", "sweep", "--input", str(written), "--json")["outputs"]["notes"],
        "coasted": flown.lvlh_m.tolist(),
    }


class Coasting:
    """No thrust."""

    def command(self, k: int, state: object) -> list[float]:
        """Nothing."""
        return [0.0, 0.0, 0.0]


def form(client: TestClient, folder: Path) -> dict[str, Any]:
    """The form `jsonl` by its name and by its media type, and in the description."""
    inputs = POINT | {"states": [START, {"x_m": 90, "y_m": 20}]}
    where = f"/jobs/{_done(client, folder, '/processes/go-no-go/execution', inputs)}/results"
    named = client.get(where, params={"format": "jsonl", "table": "states"})
    negotiated = client.get(where, headers={"Accept": "application/jsonl"})
    operation = client.get("/openapi.json").json()["paths"]["/jobs/{jobID}/results"]["get"]
    return {
        "named": named.text,
        "file": named.headers["content-disposition"],
        "negotiated": [negotiated.headers["content-type"], negotiated.text == named.text],
        "offered": list(operation["responses"]["200"]["content"]),
        "parameter": _parameter(client, "/jobs/{jobID}/results", "format"),
    }


def _done(client: TestClient, folder: Path, where: str, inputs: dict[str, Any]) -> str:
    """Id of a job with its result."""
    answer = client.post(where, json={"inputs": inputs}, headers={"Prefer": "respond-async"})
    jobs = jobs_of(folder)
    claim = jobs.claim("tester", 60.0)
    assert claim is not None
    jobs.succeed(claim, execute(claim.process_id, claim.inputs).document, (), {})
    job: str = answer.json()["jobID"]
    return job


def _parameter(client: TestClient, path: str, name: str) -> dict[str, Any]:
    operation = client.get("/openapi.json").json()["paths"][path]["get"]
    return next(one for one in operation["parameters"] if one["name"] == name)


def _command(*arguments: str) -> Any:
    done = CliRunner().invoke(build(), arguments)
    assert done.exit_code == 0, done.output
    return json.loads(done.stdout)


PARTS = (process, method, controller, form, motion)

if __name__ == "__main__":
    where = Path(sys.argv[1])
    for package in (safestart, safestart_service):
        assert Path(str(package.__file__)).is_relative_to(where), "the copy is asked"
    # The copy's kernels are compiled anew, which takes long on a busy machine: after a minute it is 503.
    with service(where) as asked:
        proof = POINT | START | {"method": "exact"}
        until(lambda: asked.get("/go-no-go/proof", params=proof).status_code != 503, "a helper process")
        print(json.dumps({part.__name__: part(asked, where) for part in PARTS}))
