"""A Dask scheduler that takes only TLS: which workers it accepts, and the messages to the others.

Jobs on one are in ``test_existing_cluster``.
"""

from __future__ import annotations

import asyncio
from pathlib import Path

import dask
import pytest
from distributed import Scheduler

from safestart.errors import InvalidInput, Unavailable
from safestart_worker.cluster.opening import open_cluster
from tests.acceptance.certificates import Authority

TLS = "tls://127.0.0.1:{}"


@pytest.fixture(scope="module")
def ours(tmp_path_factory: pytest.TempPathFactory) -> Authority:
    return Authority(tmp_path_factory.mktemp("certificates") / "ours")


@pytest.fixture(scope="module")
def theirs(tmp_path_factory: pytest.TempPathFactory) -> Authority:
    return Authority(tmp_path_factory.mktemp("certificates") / "theirs")


def attempt(scheduler: Authority | None, address: str, configuration: dict[str, str]) -> None:
    """Open ``address`` (its port is put in) of a scheduler with TLS by ``scheduler``'s certificates, or without."""

    async def run() -> None:
        options = {"host": "127.0.0.1", "port": 0, "dashboard_address": "127.0.0.1:0"}
        with dask.config.set({} if scheduler is None else _tls(scheduler.configuration())):
            server = Scheduler(protocol="tcp://" if scheduler is None else "tls://", **options)
        async with server:
            with dask.config.set(_tls(configuration)):
                async with open_cluster(address.format(server.port), 0, 3, "test") as cluster:
                    assert not cluster.lost

    asyncio.run(run())


def _tls(configuration: dict[str, str]) -> dict[str, str]:
    return {f"distributed.comm.{name}": value for name, value in configuration.items()}


def test_who_has_a_certificate_of_its_authority_is_let_in(ours: Authority) -> None:
    attempt(ours, TLS, ours.configuration())


def test_without_certificates_they_are_asked_for(ours: Authority) -> None:
    with pytest.raises(
        InvalidInput, match=r"certificates for tls://127.* \(DASK_DISTRIBUTED__COMM__TLS__.*CA_FILE"
    ):
        attempt(ours, TLS, {})


def test_a_scheduler_of_another_authority_is_not_trusted(ours: Authority, theirs: Authority) -> None:
    with pytest.raises(
        Unavailable, match=r"signed by DASK_DISTRIBUTED__COMM__TLS__CA_FILE.*another certificate"
    ):
        attempt(ours, TLS, theirs.configuration())


def test_a_certificate_of_another_authority_is_not_accepted(ours: Authority, theirs: Authority) -> None:
    mixed = theirs.configuration() | {"tls.ca-file": str(ours.ca)}
    with pytest.raises(
        Unavailable, match=r"accepts the certificate of the client.*closed connection from tls://"
    ):
        attempt(ours, TLS, mixed)


def test_a_plain_address_of_it_is_told_of_tls(ours: Authority) -> None:
    with pytest.raises(Unavailable, match=r"closed connection from tcp://127.*takes only tls://"):
        attempt(ours, "tcp://127.0.0.1:{}", {})


def test_a_scheduler_without_tls_is_told_apart(ours: Authority) -> None:
    with pytest.raises(Unavailable, match=r"answers in TLS, received no TLS from tls://127"):
        attempt(None, TLS, ours.configuration())


def test_configuration_that_cannot_be_kept_is_named(ours: Authority, tmp_path: Path) -> None:
    empty = tmp_path / "empty.pem"
    empty.touch()
    for wrong in (empty, tmp_path / "absent.pem"):
        with pytest.raises(InvalidInput, match=r"required certificates that can be read"):
            attempt(ours, TLS, ours.configuration() | {"tls.ca-file": str(wrong)})
    with pytest.raises(InvalidInput, match=r"requires encryption, received 127"):
        attempt(ours, "127.0.0.1:{}", {"require-encryption": "true"})
