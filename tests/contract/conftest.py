"""Databases on every backend and clients of the service, for the tests of the contract."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from safestart.runtime.access import Role
from safestart.store.access.keys import KeyRepository
from safestart.store.database import Database
from safestart.store.jobs.repository import JobRepository
from safestart.store.jobs.results import ResultRepository
from tests.contract.access.key_holders import BY
from tests.contract.api.service_client import SMALL, jobs_of, service
from tests.contract.server.raw_http import Address, small_server
from tests.contract.store.store_backends import BACKENDS, fresh_url


@pytest.fixture(params=BACKENDS)
def url(request: pytest.FixtureRequest, tmp_path: Path) -> str:
    return fresh_url(request.param, tmp_path)


@pytest.fixture
def database(url: str) -> Iterator[Database]:
    database = Database(url)
    database.migrate()
    yield database
    database.close()


@pytest.fixture
def jobs(database: Database) -> JobRepository:
    return JobRepository(database)


@pytest.fixture
def results(database: Database) -> ResultRepository:
    return ResultRepository(database)


@pytest.fixture
def keys(database: Database) -> KeyRepository:
    return KeyRepository(database)


@pytest.fixture(scope="session")
def execution() -> Any:
    """A small benchmark that ran."""
    from safestart.processes.execute import execute

    return execute("benchmark", SMALL)


@pytest.fixture
def guarded(tmp_path: Path):
    """A client, keys of every role, and the repository beside it."""
    with service(tmp_path) as client:
        found = client.app.state.services
        made = {role.value: found.keys.create(role.value, role, 1.0, BY)[1] for role in Role}
        found.keyring.load()
        yield client, made, found


@pytest.fixture(scope="module")
def client(tmp_path_factory):
    """For calls that leave no jobs."""
    with service(tmp_path_factory.mktemp("shared")) as found:
        yield found


@pytest.fixture
def queue(tmp_path: Path):
    """A client and its queue, empty at first."""
    with service(tmp_path) as found:
        yield found, jobs_of(tmp_path)


@pytest.fixture(scope="session")
def address(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Address]:
    """A real server for bytes on the wire."""
    with small_server(tmp_path_factory.mktemp("wire")) as found:
        yield found
