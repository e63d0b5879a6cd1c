"""A PostgreSQL server of our own, to be killed: in a folder of its own, as an unprivileged user."""

from __future__ import annotations

import os
import pwd
import shutil
import signal
import subprocess
from pathlib import Path

import psutil
import psycopg
import pytest

from tests.waiting import free_port, until

NEEDED = ("initdb", "postgres")
USER = "postgres"


class Server:
    """``start``, ``kill`` and ``start`` again; the data stays."""

    def __init__(self, folder: Path) -> None:
        self._folder, self._binaries = folder, _binaries()
        self._as = _as_user()
        if self._as:
            user = pwd.getpwnam(USER)
            os.chown(folder, user.pw_uid, user.pw_gid)
        options = ["-D", str(folder / "data"), "-U", USER, "-A", "trust", "-E", "UTF8", "--locale=C", "-N"]
        made = subprocess.run(
            [*self._as, self._binaries["initdb"], *options], capture_output=True, text=True, cwd=folder
        )
        assert made.returncode == 0, made.stderr
        self.port = free_port()
        self.url = f"postgresql://{USER}@127.0.0.1:{self.port}/postgres"
        self._process: subprocess.Popen[bytes] | None = None

    def start(self) -> None:
        """Start and wait until it answers; after a kill it recovers first."""
        options = {
            "port": self.port,
            "listen_addresses": "127.0.0.1",
            "unix_socket_directories": str(self._folder),
            "shared_buffers": "16MB",
        }
        command = [*self._as, self._binaries["postgres"], "-D", str(self._folder / "data")]
        for name, value in options.items():
            command += ["-c", f"{name}={value}"]
        with (self._folder.parent / "server.log").open("ab") as log:
            self._process = subprocess.Popen(command, stdout=log, stderr=log, cwd=self._folder)
        until(self._answers, "the database server", log=self._folder.parent / "server.log")

    def _answers(self) -> bool:
        try:
            psycopg.connect(self.url, connect_timeout=20).close()
        except psycopg.OperationalError:
            return False
        return True

    def kill(self) -> None:
        """SIGKILL every process of the server at once, as a power cut would."""
        assert self._process is not None
        family = [psutil.Process(self._process.pid)]
        family += family[0].children(recursive=True)
        for process in family:
            try:
                process.send_signal(signal.SIGKILL)
            except psutil.NoSuchProcess:
                continue
        psutil.wait_procs(family, timeout=60)
        self._process.wait()
        (self._folder / "data" / "postmaster.pid").unlink(missing_ok=True)


def _binaries() -> dict[str, str]:
    """The server's programs; skips where there are none."""
    folders = [*Path("/usr/lib/postgresql").glob("*/bin")]
    path = os.pathsep.join([os.environ.get("PATH", ""), *map(str, folders)])
    found = {name: shutil.which(name, path=path) for name in NEEDED}
    if not all(found.values()):
        pytest.skip("no PostgreSQL server programs (initdb, postgres) on this machine")
    return {name: str(where) for name, where in found.items()}


def _as_user() -> list[str]:
    """What runs a command as an unprivileged user: the server refuses to run as root."""
    if os.geteuid() != 0:
        return []
    try:
        pwd.getpwnam(USER)
    except KeyError:
        pytest.skip(f"the server refuses to run as root, and there is no user {USER}")
    runuser = shutil.which("runuser")
    if runuser is None:
        pytest.skip("the server refuses to run as root, and there is no runuser")
    return [runuser, "-u", USER, "--"]
