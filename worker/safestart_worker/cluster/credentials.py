"""Access to a Dask cluster: own certificates for the embedded cluster, Dask's configuration elsewhere.

Dask runs any code it receives, and every local account can reach a loopback port. So the embedded cluster, too,
accepts only connections whose peer has its certificate.
"""

from __future__ import annotations

import ssl
from datetime import UTC, datetime

from cryptography import x509
from cryptography.hazmat.primitives import hashes, serialization
from cryptography.hazmat.primitives.asymmetric import ec
from cryptography.x509.oid import NameOID
from distributed import Security
from distributed.comm.addressing import normalize_address
from distributed.comm.core import CommClosedError

from safestart.errors import InvalidInput, SafestartError, Unavailable

_NAMES = "DASK_DISTRIBUTED__COMM__TLS__{CA_FILE,CLIENT__CERT,CLIENT__KEY}"
# The certificate lives as long as its process: it must not expire earlier or depend on the clock.
_FROM, _TO = datetime(1970, 1, 1, tzinfo=UTC), datetime(9999, 12, 31, tzinfo=UTC)


def throwaway() -> Security:
    """A new key and its certificate, kept in memory; the cluster admits only processes that have both.

    Dask's own ``Security.temporary`` is valid from now for one year: after a clock change, or after a year, no task
    process could come back.
    """
    key = ec.generate_private_key(ec.SECP256R1())
    name = x509.Name([x509.NameAttribute(NameOID.COMMON_NAME, "safestart")])
    certificate = (
        x509.CertificateBuilder()
        .subject_name(name)
        .issuer_name(name)
        .public_key(key.public_key())
        .serial_number(x509.random_serial_number())
        .not_valid_before(_FROM)
        .not_valid_after(_TO)
        .add_extension(x509.BasicConstraints(ca=True, path_length=None), critical=True)
        .sign(key, hashes.SHA256())
        .public_bytes(serialization.Encoding.PEM)
        .decode()
    )
    secret = key.private_bytes(
        serialization.Encoding.PEM, serialization.PrivateFormat.PKCS8, serialization.NoEncryption()
    ).decode()
    roles = ("client", "scheduler", "worker")
    pairs = {f"tls_{role}_cert": certificate for role in roles} | {
        f"tls_{role}_key": secret for role in roles
    }
    return Security(
        require_encryption=True, tls_min_version=ssl.TLSVersion.TLSv1_3, tls_ca_file=certificate, **pairs
    )


def configured(scheduler: str) -> Security:
    """The certificates of Dask's configuration; raises ``InvalidInput`` when ``scheduler`` needs missing ones."""
    try:
        security = Security()
        complete = security.get_connection_args("client")["ssl_context"] is not None
    except (OSError, ValueError) as error:  # the file is missing or has no certificate
        raise _wrong(f"certificates that can be read ({_NAMES})", str(error)) from error
    encrypted = normalize_address(scheduler).startswith("tls://")
    if encrypted and not complete:
        raise _wrong(f"certificates for {scheduler} ({_NAMES})", "none")
    if security.require_encryption and not encrypted:
        raise _wrong("tls://host:port, as Dask's configuration requires encryption", scheduler)
    return security


def refused(scheduler: str, error: Exception) -> SafestartError:
    """Why the connection to ``scheduler`` fails."""
    required = "the address of a running Dask scheduler"
    cause = error.__cause__
    if isinstance(cause, ssl.SSLCertVerificationError):
        required = f"a scheduler whose certificate is signed by {_NAMES.partition('{')[0]}CA_FILE"
        received = f"another certificate from {scheduler} ({cause.verify_message})"
    elif isinstance(cause, ssl.SSLError) and "ALERT" not in str(cause.reason):  # a TLS alert is an answer
        required, received = "a scheduler that answers in TLS", f"no TLS from {scheduler}"
    elif isinstance(error, CommClosedError) and scheduler.startswith("tls://"):
        required = "a scheduler that accepts the certificate of the client"
        received = f"a closed connection from {scheduler}"
    elif isinstance(error, CommClosedError):
        received = f"a closed connection from {scheduler}, as from one that takes only tls://"
    else:
        received = f"none at {scheduler}"
    return Unavailable(
        f"scheduler: required {required}, received {received}",
        field="scheduler",
        required=required,
        received=scheduler,
    )


def _wrong(required: str, received: str) -> InvalidInput:
    return InvalidInput(
        f"scheduler: required {required}, received {received}",
        field="scheduler",
        required=required,
        received=received,
    )
