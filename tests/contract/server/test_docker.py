"""The Docker files have the required contents, as far as tests can tell without an engine (docker/check.sh does
more)."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest
import yaml
from sqlalchemy.engine import make_url

ROOT = Path(__file__).resolve().parents[3]
IMAGES = ("service", "worker")


def steps(image: str) -> list[tuple[str, str]]:
    """Instructions of a Dockerfile with their arguments."""
    text = (ROOT / "docker" / f"{image}.Dockerfile").read_text().replace("\\\n", " ")
    lines = [line for line in text.splitlines() if line and not line.startswith("#")]
    return [(line.split(None, 1)[0], line.split(None, 1)[1]) for line in lines]


@pytest.fixture(scope="module")
def compose() -> dict[str, Any]:
    document: dict[str, Any] = yaml.safe_load((ROOT / "docker" / "compose.yaml").read_text())
    return document


@pytest.mark.parametrize("image", IMAGES)
def test_images_run_as_somebody_and_can_be_asked_how_they_are(image: str) -> None:
    last = [i for i, (name, _) in enumerate(steps(image)) if name == "FROM"][-1]
    final = dict(steps(image)[last:])
    assert final["USER"] == "10001"
    assert "CMD" in final["HEALTHCHECK"]
    names = [name for name, _ in steps(image)]
    assert names.index("USER") < names.index("CMD")


@pytest.mark.parametrize("image", IMAGES)
def test_what_is_copied_is_there_and_not_ignored(image: str) -> None:
    allowed = {line[1:] for line in (ROOT / ".dockerignore").read_text().splitlines() if line.startswith("!")}
    copied = [
        arguments.split()[0]
        for name, arguments in steps(image)
        if name == "COPY" and "--from" not in arguments
    ]
    assert set(copied) == allowed
    assert all((ROOT / path).exists() for path in copied)


def test_the_service_image_holds_no_engine() -> None:
    install = [arguments for name, arguments in steps("service") if "uv sync" in arguments]
    assert len(install) == 1
    assert install[0].endswith("--package safestart-service")
    assert "--all" not in install[0]
    assert "--no-dev" in install[0]
    dependencies = (ROOT / "service" / "pyproject.toml").read_text()
    assert not re.search(r"engines|jax|numba|distributed|safestart-worker", dependencies)


def test_the_compose_file_has_every_part(compose: dict[str, Any]) -> None:
    services = compose["services"]
    assert set(services) == {"database", "service", "scheduler", "dask-worker", "worker"}
    assert services["worker"]["deploy"]["replicas"] == 2
    for name, service in services.items():
        assert not service.get("privileged"), name
        for needed in service.get("depends_on", {}):
            assert needed in services
        for volume in service.get("volumes", ()):
            assert volume.split(":")[0] in compose["volumes"]
        if "build" in service:
            assert (ROOT / "docker" / service["build"]["context"] / service["build"]["dockerfile"]).is_file()
            assert service["read_only"] is True
            assert service["cap_drop"] == ["ALL"]
    assert all(port.startswith("127.0.0.1:") for port in services["service"]["ports"])


def test_nothing_runs_without_bounds_or_unwatched(compose: dict[str, Any]) -> None:
    watched = {image: "HEALTHCHECK" in dict(steps(image)) for image in IMAGES}
    for name, service in compose["services"].items():
        assert service["restart"] == "unless-stopped", name
        assert service["mem_limit"], name
        assert {"max-size", "max-file"} <= set(service["logging"]["options"]), name
        assert service["stop_grace_period"], name
        assert service["security_opt"] == ["no-new-privileges:true"], name
        image = service["image"].removeprefix("safestart-")
        # `docker compose up --wait` refuses a container that cannot be asked.
        assert "test" in service.get("healthcheck", {}) or watched.get(image), name


def test_who_is_on_which_network(compose: dict[str, Any]) -> None:
    """Anyone who reaches the scheduler can run code on its workers, so outsiders and the service must not reach it."""
    on = {name: set(service["networks"]) for name, service in compose["services"].items()}
    assert on == {
        "database": {"records"},
        "service": {"front", "records"},
        "scheduler": {"tasks"},
        "dask-worker": {"tasks"},
        "worker": {"records", "tasks"},
    }
    assert compose["networks"]["records"]["internal"] is True
    assert compose["networks"]["tasks"]["internal"] is True
    assert [name for name, service in compose["services"].items() if "ports" in service] == ["service"]


def test_every_process_that_imports_the_engines_has_a_place_for_their_kernels(
    compose: dict[str, Any],
) -> None:
    """Without one Numba refuses the import; the scheduler imports them too, with the tasks that pass through it."""
    instructions = steps("worker")
    volume = next(arguments for name, arguments in instructions if name == "VOLUME")
    environment = " ".join(arguments for name, arguments in instructions if name == "ENV")
    assert f"NUMBA_CACHE_DIR={volume} " in environment
    compiled = next(arguments for name, arguments in instructions if "runtime.kernels.warmup" in arguments)
    # What is written after the volume's line is not in the image.
    assert instructions.index(("RUN", compiled)) < instructions.index(("VOLUME", volume))
    users = [service for service in compose["services"].values() if service["image"] == "safestart-worker"]
    assert len(users) == 3
    for service in users:
        assert service["volumes"] == [f"kernels:{volume}"]


def test_the_service_has_a_place_of_its_own_for_the_kernels_of_exact_answers(compose: dict[str, Any]) -> None:
    instructions = steps("service")
    order = [name for name, _ in instructions]
    volume = next(arguments for name, arguments in instructions if name == "VOLUME")
    compiled = next(arguments for name, arguments in instructions if "kernels.warm" in arguments)
    assert compiled.startswith("[")
    assert order.index("VOLUME") > instructions.index(("RUN", compiled))
    environment = " ".join(arguments for name, arguments in instructions if name == "ENV")
    assert f"NUMBA_CACHE_DIR={volume}" in environment
    # Kernels are code: the workers do not run what the process that meets the outside may write.
    assert compose["services"]["service"]["volumes"] == [f"answers:{volume}"]


def test_base_images_name_their_release(compose: dict[str, Any]) -> None:
    bases = {arguments.split()[0] for image in IMAGES for name, arguments in steps(image) if name == "FROM"}
    for base in [*bases, compose["services"]["database"]["image"]]:
        assert re.fullmatch(r"(python:3\.\d+-slim|postgres:\d+)-[a-z]+", base), base


def test_passwords_come_from_a_file_and_stand_nowhere_else(compose: dict[str, Any]) -> None:
    assert compose["secrets"]["database_password"]["file"].endswith(":-./secrets/database_password}")
    assert "/docker/secrets/" in (ROOT / ".gitignore").read_text().splitlines()
    knowing = set()
    for name, service in compose["services"].items():
        for variable, value in service.get("environment", {}).items():
            if "PASSWORD" in variable:
                assert variable.endswith("_FILE")
                assert value == "/run/secrets/database_password"
                knowing.add(name)
            if "URL" in variable:
                assert make_url(value).password is None
        assert ("secrets" in service) == (name in knowing), name
    assert knowing == {"database", "service", "worker"}
