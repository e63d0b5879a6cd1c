"""What a user has configured for libraries does not reach our processes, and an unusable place is one sentence."""

import json
import os
import subprocess
import sys
import threading
from collections.abc import Iterator
from http.server import BaseHTTPRequestHandler, HTTPServer
from pathlib import Path

import matplotlib as mpl
import pytest
from matplotlib.figure import Figure

from safestart import cli
from safestart.cli.showcase import client_of
from safestart.processes.execute import execute
from safestart.processes.output import Undrawn
from safestart.processes.plotting import drawn_as, figure
from safestart.public.client import Client
from safestart.records.artifact import Artifact
from safestart.runtime.own_process import exit_code, own_configuration, place_fault
from safestart.runtime.settings import settings
from safestart.store.access.keys import KeyRepository
from safestart.store.database import Database
from tests.contract.store.store_backends import NO_SERVER, POSTGRESQL, fresh_url

ASKED = {
    "omega_t_deg_s": [3],
    "a_max_m_s2": [0.1],
    "grid": {"nx": 3, "ny": 3, "y_max_m": 60},
}
HOSTILE = {
    "MPLBACKEND": "nonsense",
    "JAX_PLATFORMS": "cuda",
    "NUMBA_DISABLE_JIT": "1",
    "NUMBA_BOUNDSCHECK": "what",
    "HTTP_PROXY": "http://127.0.0.1:9",
}
LIBPQ = {
    "PGDATESTYLE": "German",
    "PGTZ": "Asia/Tokyo",
    "PGGEQO": "bogus",
    "PGCLIENTENCODING": "SQL_ASCII",
    "PGOPTIONS": "-c datestyle=SQL,DMY -c search_path=nowhere",
    "PGSERVICE": "bogus",
    "PGSERVICEFILE": "/nowhere",
    "PGTARGETSESSIONATTRS": "bogus",
    "PGHOSTADDR": "192.0.2.1",
    "PGHOST": "192.0.2.1",
    "PGPORT": "1",
    "PGUSER": "nobody",
    "PGDATABASE": "nowhere",
    "PGCONNECT_TIMEOUT": "bogus",
    "PSYCOPG_IMPL": "bogus",
}
COMMANDS = (
    ["keys", "list"],
    ["serve", "--port", "0"],
    ["worker"],
    ["backup", "copy.sqlite3"],
    ["purge", "--older-than", "1d"],
    ["export", "some-job"],
    ["restore", "copy.sqlite3"],
)


@pytest.fixture
def fresh_settings() -> Iterator[None]:
    settings.cache_clear()
    yield
    settings.cache_clear()


@drawn_as("words.png")
def words() -> Figure:
    drawing = figure(2.0, 1.0)
    drawing.text(0.1, 0.5, r"100 % of a_max")
    return drawing


def test_variables_that_libraries_read_are_ours() -> None:
    place = {"NUMBA_CACHE_DIR": "/somewhere", "PATH": "/bin"}
    place |= {
        "PGPASSFILE": "/secret",
        "PGSSLMODE": "verify-full",
        "PGPASSWORD": "s",
        "PGREQUIREAUTH": "scram-sha-256",
    }
    environment = HOSTILE | LIBPQ | place | {"MATPLOTLIBRC": "/mine", "JAX_ENABLE_X64": "1"}
    own_configuration(environment)
    assert environment == place | {
        "HTTP_PROXY": HOSTILE["HTTP_PROXY"],
        "MATPLOTLIBRC": os.devnull,
        "MPLBACKEND": "agg",
        "NUMBA_DISABLE_JIT": "0",
        "JAX_PLATFORMS": "cpu",
    }


@pytest.mark.skipif(not POSTGRESQL, reason=NO_SERVER)
def test_variables_of_libpq_choose_no_server_and_no_session(tmp_path: Path) -> None:
    url = fresh_url("postgresql", tmp_path)
    done = subprocess.run(
        [
            sys.executable,
            "-m",
            "safestart",
            "keys",
            "create",
            "--name",
            "日本",
            "--database-url",
            url,
            "--json",
        ],
        env=os.environ | LIBPQ,
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
    database = Database(url)
    assert [key.name for key in KeyRepository(database).list()] == ["日本"]
    database.close()


@pytest.mark.slow
def test_a_command_in_a_hostile_environment(tmp_path: Path) -> None:
    """The same document and the same picture as here, from a process with the user's LaTeX, backend and no home."""
    (tmp_path / "matplotlibrc").write_text(
        "text.usetex: True\nfont.family: cursive\n"
    )  # in the working directory
    (tmp_path / "inputs.json").write_text(json.dumps(ASKED))
    command = ["run", "coverage", "--input", "inputs.json", "--output", "found.json"]
    done = subprocess.run(
        [sys.executable, "-m", "safestart", *command],
        cwd=tmp_path,
        env=os.environ | HOSTILE | {"HOME": "/nonexistent/home"},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
    here = execute("coverage", ASKED)
    there = json.loads((tmp_path / "found.json").read_text())
    assert there["outputs"] == here.document["outputs"]
    assert "notes" not in there["provenance"]
    assert (tmp_path / "found.coverage.png").read_bytes() == here.artifacts[0].data


def test_pictures_have_our_style_in_the_users_program() -> None:
    plain = words()
    assert isinstance(plain, Artifact)
    with mpl.rc_context({"text.usetex": True, "font.size": 40.0, "savefig.facecolor": "red"}):
        assert words() == plain
        assert mpl.rcParams["font.size"] == 40.0


def test_a_failed_picture_is_a_note_and_the_numbers_stay(
    monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    whole = execute("coverage", ASKED)

    def full(*_: object, **__: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(Figure, "savefig", full)
    assert words() == Undrawn("words.png", "OSError: [Errno 28] No space left on device")
    bare = execute("coverage", ASKED)
    assert bare.document["outputs"] == whole.document["outputs"]
    note = "coverage.png could not be drawn (OSError: [Errno 28] No space left on device)."
    assert bare.document["provenance"]["notes"] == [note]
    assert [item.name for item in whole.artifacts] == ["coverage.png", "masks.npz"]
    assert [item.name for item in bare.artifacts] == ["masks.npz"]
    assert "coverage.png could not be drawn" in caplog.text


@pytest.mark.parametrize("command", COMMANDS, ids=lambda command: command[0])
@pytest.mark.usefixtures("fresh_settings")
def test_no_data_directory_is_one_sentence(
    command: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "file").write_text("not a directory")
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path / "file"))
    monkeypatch.delenv("SAFESTART_DATABASE_URL", raising=False)
    monkeypatch.setattr(sys, "argv", ["safestart", *command])
    monkeypatch.chdir(tmp_path)
    assert exit_code(cli.build()) == 2
    lines = capsys.readouterr().err.splitlines()
    assert len(lines) == 1
    assert lines[0].startswith("safestart")
    assert "data directory that can be made, received" in lines[0]


@pytest.mark.usefixtures("fresh_settings")
def test_an_account_without_a_home_gets_no_folder_named_tilde(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    for name in ("XDG_DATA_HOME", "XDG_CONFIG_HOME"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setattr(os.path, "expanduser", lambda path: path)
    monkeypatch.delenv("SAFESTART_DATABASE_URL", raising=False)
    monkeypatch.setattr(sys, "argv", ["safestart", "keys", "list"])
    assert exit_code(cli.build()) == 2
    assert "received this account has no home directory" in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []


def test_only_faults_of_a_place_become_a_sentence(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError) as missing:
        (tmp_path / "none" / "file").read_bytes()
    fault = place_fault(missing.value)
    assert fault is not None
    assert fault.detail == (
        "required a place that exists and accepts our files, "
        f"received {tmp_path / 'none' / 'file'} (No such file or directory)"
    )
    assert place_fault(ConnectionResetError(104, "reset")) is None
    assert place_fault(PermissionError(13, "of something without a name")) is None


class _Answer(BaseHTTPRequestHandler):
    def do_GET(self) -> None:
        self.send_response(200)
        self.send_header("Content-Type", "application/json")
        self.send_header("Content-Length", "2")
        self.end_headers()
        self.wfile.write(b"{}")

    def log_message(self, *_: object) -> None:
        pass


def test_a_proxy_is_not_asked_for_this_machine(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("HTTP_PROXY", "http_proxy", "ALL_PROXY"):
        monkeypatch.setenv(name, "http://127.0.0.1:9")
    for name in ("NO_PROXY", "no_proxy"):
        monkeypatch.delenv(name, raising=False)
    server = HTTPServer(("127.0.0.1", 0), _Answer)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    url = f"http://127.0.0.1:{server.server_port}"
    try:
        with client_of(url) as client:
            assert client.get("/readyz").json() == {}
        for host in ("127.0.0.1", "localhost"):
            with Client(f"http://{host}:{server.server_port}") as client:
                assert client._wire.get("/") == {}
    finally:
        server.shutdown()
        server.server_close()
