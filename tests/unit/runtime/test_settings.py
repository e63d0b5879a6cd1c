"""Settings: their sources, and the messages for wrong ones."""

from __future__ import annotations

import os
import subprocess
import sys
import zipfile
from collections.abc import Iterator
from pathlib import Path

import pytest

from safestart.cli import build
from safestart.errors import InvalidInput
from safestart.runtime.own_process import exit_code
from safestart.runtime.settings import Settings, settings
from safestart.runtime.variables import NAMES
from safestart.store.database import Database
from tests.waiting import PATIENCE_S


@pytest.fixture(autouse=True)
def alone(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """No settings of this machine, none of another test."""
    for name in [name for name in os.environ if name.upper().startswith("SAFESTART_")]:
        monkeypatch.delenv(name)
    settings.cache_clear()
    monkeypatch.setattr("safestart.runtime.settings_sources.user_config_path", lambda _: Path("/nonexistent"))
    yield
    settings.cache_clear()


@pytest.fixture
def file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The settings file, empty at first."""
    path = tmp_path / "some.toml"
    path.write_text("")
    monkeypatch.setenv("SAFESTART_CONFIG", str(path))
    return path


def test_arguments_come_before_the_environment_before_the_file(
    file: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    file.write_text("port = 1\nlease_s = 30\npoll_s = 0.5\n")
    monkeypatch.setenv("SAFESTART_PORT", "2")
    monkeypatch.setenv("SAFESTART_LEASE_S", "40")
    found = Settings(port=3)
    assert (found.port, found.lease_s, found.poll_s, found.max_attempts) == (3, 40.0, 0.5, 3)
    assert settings() is settings()


def test_a_name_that_is_too_long_is_no_file(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SAFESTART_CONFIG", "a" * 1000)
    settings.cache_clear()
    with pytest.raises(InvalidInput, match="SAFESTART_CONFIG: required the path of a TOML file"):
        settings()
    settings.cache_clear()


@pytest.mark.parametrize(
    ("name", "value", "required"),
    [
        ("port", "x", "an integer"),
        ("port", "", "an integer"),
        ("port", "70000", "a number <= 65535"),
        ("lease_s", "nan", "a number"),
        ("rate_per_s", "0", "a number > 0"),
        ("log_format", "xml", "one of 'text' or 'json'"),
        ("max_queued", "1e4", "an integer"),
        ("keep_days", "-1", "a number >= 0"),
        ("port", "8_000", "a number without _ between its digits"),
        ("port", " 8000", "a number without spaces and without a plus sign"),
        ("port", "+8000", "a number without spaces and without a plus sign"),
        ("port", "٨٠٠٠", "a number in the digits 0 to 9"),
        ("lease_s", "1_0", "a number without _ between its digits"),
        ("lease_s", "10\n", "a number without spaces"),
    ],
)
def test_a_wrong_variable_is_named_with_what_was_required_and_what_came(
    name: str, value: str, required: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv(f"SAFESTART_{name.upper()}", value)
    with pytest.raises(InvalidInput) as caught:
        settings()
    assert caught.value.detail.startswith(f"settings.{name}: required {required}")
    assert f"received {value!r}" in caught.value.detail


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (b"prot = 9", "settings.prot: required the name of a setting, such as port"),
        (b"Port = 22060\nport = 22061", "settings.Port: required the name of a setting, such as port"),
        (b"PORT = 9", "settings.PORT: required the name of a setting, such as port"),
        (b"[safestart]\nport = 9", "settings.safestart: required the name of a setting"),
        (b"port = = 9", r"required a readable TOML file in UTF-8, received 'Invalid value \(at line 1"),
        (b"host = '\xff'", "required a readable TOML file in UTF-8"),
        (b"port = [9]", "settings.port: required an integer"),
        (b"a = " + b"[" * 100_000, "required a readable TOML file in UTF-8, received 'one nested too deeply"),
        (
            b"a = " + b"{a = " * 50_000,
            "required a readable TOML file in UTF-8, received 'one nested too deeply",
        ),
    ],
)
def test_a_wrong_file_is_refused_with_the_reason(file: Path, content: bytes, said: str) -> None:
    file.write_bytes(content)
    with pytest.raises(InvalidInput, match=said):
        settings()


NUMBERS = [name for name, field in Settings.model_fields.items() if field.annotation in (int, float)]


@pytest.mark.parametrize("name", NUMBERS)
@pytest.mark.parametrize("value", ["true", "false", "'18540'", "''", "'1.0'"])
def test_a_file_has_numbers_for_numbers(file: Path, name: str, value: str) -> None:
    """TOML has texts and booleans of its own: `port = true` was port 1."""
    file.write_text(f"{name} = {value}\n")
    with pytest.raises(InvalidInput, match=f"settings.{name}: required (an integer|a number), received"):
        settings()


def test_every_setting_of_a_file_is_of_a_kind_that_is_checked() -> None:
    """Texts are checked by pydantic; another kind of setting needs a rule of its own."""
    others = {
        name for name, field in Settings.model_fields.items() if field.annotation not in (int, float, str)
    }
    assert others == {"warm_up", "log_format"}


def test_a_file_may_write_a_whole_number_with_a_point(file: Path) -> None:
    file.write_text("port = 8001.0\nlease_s = 30\n")
    assert (settings().port, settings().lease_s) == (8001, 30.0)


def test_variables_are_texts(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SAFESTART_PORT", "18540")
    assert settings().port == 18540


@pytest.mark.parametrize("place", ["database_url", "database"])
def test_a_url_in_the_wrong_place_shows_no_password(file: Path, place: str) -> None:
    file.write_text(f"[{place}]\nurl = 'postgresql://user:hunter2@host/name'\n")
    with pytest.raises(InvalidInput, match=f"settings.{place}: required") as caught:
        settings()
    assert "hunter2" not in caught.value.detail


@pytest.mark.parametrize("named", ["nothing.toml", "."])
def test_a_named_file_that_is_not_there_is_refused(
    named: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("SAFESTART_CONFIG", str(tmp_path / named))
    with pytest.raises(InvalidInput, match="SAFESTART_CONFIG: required the path of a TOML file"):
        settings()


def test_without_any_file_there_are_the_defaults() -> None:
    assert settings().port == 8000


@pytest.mark.parametrize(
    ("name", "near"),
    [
        ("SAFESTART_PROT", "SAFESTART_PORT"),
        ("SAFESTART_DATABSE_URL", "SAFESTART_DATABASE_URL"),
        ("SAFESTART_RATE_PER_SECOND", "SAFESTART_RATE_PER_S"),
        ("SAFESTART_CONFIG_FILE", "SAFESTART_CONFIG"),
        ("safestart_prot", "SAFESTART_PORT"),
        ("safestart_port", "SAFESTART_PORT"),
        ("Safestart_Config", "SAFESTART_CONFIG"),
        ("SAFESTART_ZZZ", None),
        ("SAFESTART_", None),
    ],
)
def test_a_variable_that_names_no_setting_is_refused(
    name: str, near: str | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv(name, "postgresql://user:hunter2@host/name")
    with pytest.raises(InvalidInput, match=f"^{name}: required the name of a setting") as caught:
        settings()
    assert near is None or f"such as {near} (" in caught.value.detail
    assert "hunter2" not in str((caught.value.detail, caught.value.received))


def test_variables_that_are_known_are_not_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("SAFESTART_PORT", "SAFESTART_TEST_POSTGRESQL", "SAFE_START", "XSAFESTART_PORT"):
        monkeypatch.setenv(name, "1")
    assert settings().port == 1


COMMANDS = (
    *(["keys", *more] for more in (["create", "--name", "a"], ["list"], ["revoke", "x"], ["audit"])),
    *(["label", "job"], ["export", "job"], ["backup", "copy"], ["restore", "copy"]),
    *(["purge", "--older-than", "1d"], ["replay", "job"]),
)


@pytest.mark.parametrize("command", COMMANDS, ids=" ".join)
def test_a_command_that_is_given_its_database_reads_all_settings(
    command: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("SAFESTART_PORT", "abc")
    url = f"sqlite:///{tmp_path / 'some.sqlite3'}"
    Database(url).migrate()
    assert exit_code(lambda: build()([*command, "--database-url", url])) == 2
    assert "settings.port: required an integer" in capsys.readouterr().err


def test_a_replay_of_a_file_reads_all_settings(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "a.zip"
    with zipfile.ZipFile(file, "w"):
        pass
    monkeypatch.setenv("SAFESTART_CONFIG", str(tmp_path / "none.toml"))
    assert exit_code(lambda: build()(["replay", str(file)])) == 2
    assert "SAFESTART_CONFIG: required" in capsys.readouterr().err


@pytest.mark.slow
@pytest.mark.parametrize("command", ["serve", "worker", "up", "purge"])
def test_a_misspelt_variable_stops_every_start(command: str) -> None:
    more = ["--older-than", "1d"] if command == "purge" else []
    environment = {**os.environ, "SAFESTART_PROT": "1"}
    ended = subprocess.run(
        [sys.executable, "-m", "safestart", command, *more],
        capture_output=True,
        text=True,
        env=environment,
        timeout=PATIENCE_S,
    )
    assert ended.returncode == 2
    assert "SAFESTART_PORT" in ended.stderr
    assert len(ended.stderr.strip().splitlines()) == 1


def test_the_names_that_every_command_knows_are_those_of_the_settings() -> None:
    assert tuple(Settings.model_fields) == NAMES
