"""An authority and a certificate that it signed, as an operator would make them for a Dask cluster or a proxy."""

from __future__ import annotations

import ipaddress
from datetime import UTC, datetime, timedelta
from pathlib import Path

from cryptography import x509
from cryptography.hazmat.primitives import hashes, serialization
from cryptography.hazmat.primitives.asymmetric import ec
from cryptography.x509.oid import NameOID


class Authority:
    """Makes its files in ``folder``: ``ca.pem``, ``cert.pem``, ``key.pem``; the certificate is for ``host``."""

    def __init__(self, folder: Path, host: str = "dask") -> None:
        folder.mkdir()
        self.ca, self.certificate, self.key = (folder / f"{name}.pem" for name in ("ca", "cert", "key"))
        signer, key = (ec.generate_private_key(ec.SECP256R1()) for _ in range(2))
        self.ca.write_bytes(_signed("authority", signer.public_key(), signer, ca=True))
        self.certificate.write_bytes(_signed(host, key.public_key(), signer, ca=False))
        pem, form = serialization.Encoding.PEM, serialization.PrivateFormat.PKCS8
        self.key.write_bytes(key.private_bytes(pem, form, serialization.NoEncryption()))

    def configuration(self) -> dict[str, str]:
        """Dask's settings for every role, by their names below ``distributed.comm``."""
        pairs = {"cert": str(self.certificate), "key": str(self.key)}
        roles = {
            f"tls.{role}.{name}": path
            for role in ("scheduler", "worker", "client")
            for name, path in pairs.items()
        }
        return {"tls.ca-file": str(self.ca)} | roles

    def environment(self) -> dict[str, str]:
        """The same as variables of the environment."""
        prefix = "DASK_DISTRIBUTED__COMM__"
        return {
            prefix + name.replace("-", "_").replace(".", "__").upper(): path
            for name, path in self.configuration().items()
        }


def _signed(
    name: str, key: ec.EllipticCurvePublicKey, signer: ec.EllipticCurvePrivateKey, *, ca: bool
) -> bytes:
    subject, issuer = (
        x509.Name([x509.NameAttribute(NameOID.COMMON_NAME, who)]) for who in (name, "authority")
    )
    now = datetime.now(UTC)
    names = [x509.DNSName(name), x509.IPAddress(ipaddress.ip_address("127.0.0.1"))]
    return (
        x509.CertificateBuilder()
        .subject_name(subject)
        .issuer_name(issuer)
        .public_key(key)
        .serial_number(x509.random_serial_number())
        .not_valid_before(now - timedelta(days=1))
        .not_valid_after(now + timedelta(days=1))
        .add_extension(x509.BasicConstraints(ca=ca, path_length=None), critical=True)
        .add_extension(x509.SubjectAlternativeName(names), critical=False)
        .sign(signer, hashes.SHA256())
        .public_bytes(serialization.Encoding.PEM)
    )
