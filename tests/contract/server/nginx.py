"""nginx with the file of docs/operations.md, and variants of it, before services of its own."""

from __future__ import annotations

import os
import shutil
import ssl
import subprocess
import sys
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path

import httpx

from tests.acceptance.certificates import Authority
from tests.contract.api.service_client import url_of
from tests.waiting import PATIENCE_S, accepts, free_port, until

NGINX = shutil.which("nginx") or shutil.which("nginx", path="/usr/sbin:/usr/local/sbin")
NAME = "safestart.example"
ROOT = "/safestart"
VARIANTS = ("as printed", "unstripped", "stripped, root_path", "unstripped, root_path")
_SLASH = "proxy_pass http://127.0.0.1:8000/;"
_PREFIX = f"proxy_set_header X-Forwarded-Prefix {ROOT};"
_MAIN = """
daemon off; master_process off; worker_processes 1; pid {folder}/nginx.pid; error_log {folder}/error.log;
events {{ worker_connections 256; }}
http {{
    types {{ text/html html; }}
    access_log off;
    client_body_temp_path {folder}/body; proxy_temp_path {folder}/proxy; fastcgi_temp_path {folder}/f;
    uwsgi_temp_path {folder}/u; scgi_temp_path {folder}/s;
    {servers}
}}
"""


@dataclass(frozen=True)
class Front:
    """One server of nginx: its port, the authority of its certificate, and the folder of the service's database."""

    port: int
    authority: str
    folder: Path

    @property
    def base(self) -> str:
        """The address that clients know."""
        return f"https://{NAME}:{self.port}{ROOT}"

    def client(self) -> httpx.Client:
        """A client that finds :data:`NAME` on this machine and checks the certificate."""
        trust = ssl.create_default_context(cafile=self.authority)
        trust.verify_flags &= ~ssl.VERIFY_X509_STRICT  # the authority is a plain one
        headers = {"Host": f"{NAME}:{self.port}"}
        return httpx.Client(verify=trust, headers=headers, timeout=PATIENCE_S, base_url=self.local(self.base))

    def local(self, url: str) -> str:
        """The same address, as this machine's resolver finds it."""
        assert url.startswith(self.base), url
        return url.replace(NAME, "127.0.0.1", 1)


@contextmanager
def fronts(folder: Path, variants: Sequence[str] = VARIANTS) -> Iterator[dict[str, Front]]:
    """Some of :data:`VARIANTS`, or all."""
    assert NGINX is not None
    authority = Authority(folder / "certificates", NAME)
    with ExitStack() as stack:
        services = {
            root: stack.enter_context(_service(folder / f"service{root[1:]}", root))
            for root in sorted({_root(variant) for variant in variants})
        }
        ports = {variant: free_port() for variant in variants}
        servers = [_server(variant, ports[variant], services, authority) for variant in variants]
        file = folder / "nginx.conf"
        file.write_text(_MAIN.format(folder=folder, servers="\n".join(servers)))
        process = subprocess.Popen([NGINX, "-p", str(folder), "-c", str(file)], stderr=subprocess.DEVNULL)
        stack.callback(process.wait, PATIENCE_S)
        stack.callback(process.terminate)
        until(
            lambda: process.poll() is None and all(map(accepts, ports.values())),
            "nginx",
            log=folder / "error.log",
        )
        yield {
            variant: Front(port, str(authority.ca), folder / f"service{_root(variant)[1:]}")
            for variant, port in ports.items()
        }


def printed() -> str:
    """The file in docs/operations.md."""
    text = (Path(__file__).parents[3] / "docs" / "operations.md").read_text(encoding="utf-8")
    return text.partition("```nginx\n")[2].partition("```")[0]


def _root(variant: str) -> str:
    return ROOT if "root_path" in variant else ""


def _server(variant: str, port: int, services: dict[str, int], authority: Authority) -> str:
    text = printed()
    changes = [
        ("listen 443 ssl;", f"listen 127.0.0.1:{port} ssl;"),
        ("/etc/safestart/cert.pem", str(authority.certificate)),
        ("/etc/safestart/key.pem", str(authority.key)),
    ]
    if variant.startswith("unstripped"):
        changes.append((_SLASH, _SLASH.replace("/;", ";")))
    if _root(variant):
        changes.append((_PREFIX, 'proxy_set_header X-Forwarded-Prefix "";'))
    changes.append(("127.0.0.1:8000", f"127.0.0.1:{services[_root(variant)]}"))
    for old, new in changes:
        assert text.count(old) == 1, old
        text = text.replace(old, new)
    return text


@contextmanager
def _service(folder: Path, root: str) -> Iterator[int]:
    folder.mkdir()
    environment = os.environ | {"SAFESTART_ALLOWED_HOSTS": NAME, "SAFESTART_ROOT_PATH": root}
    command = [sys.executable, "-m", "safestart_service", "--port", "0", "--database-url", url_of(folder)]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=environment)
    assert process.stdout is not None
    try:
        yield int(process.stdout.readline().split()[1].split(":")[2].partition("/")[0])
    finally:
        process.terminate()
        process.wait(PATIENCE_S)
