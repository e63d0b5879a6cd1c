"""Settings of every part: ``SAFESTART_*`` variables, or a TOML file named by ``SAFESTART_CONFIG``."""

from __future__ import annotations

import ipaddress
import os
import re
from errno import ENOENT
from functools import cache
from typing import Any, Literal

from platformdirs import user_data_path
from pydantic import Field, ValidationError, field_validator
from pydantic_settings import BaseSettings, PydanticBaseSettingsSource, SettingsConfigDict

from safestart.errors import InvalidInput
from safestart.model.validation import refusal
from safestart.runtime.files.secret_file import with_password
from safestart.runtime.settings_sources import of_file, of_variables, place
from safestart.runtime.variables import PREFIX, require_known

Network = ipaddress.IPv4Network | ipaddress.IPv6Network

LONGEST_PATH = 200
PATH_RULE = (
    f"empty, or /name/name of letters, digits, '-', '_', '.' and '~', at most {LONGEST_PATH} characters"
)
_PATH = re.compile(r"(?:/[A-Za-z0-9._~-]+)+")


def path_below(text: str) -> str:
    """A path without its last slash; empty for the root. Raises ``ValueError`` with :data:`PATH_RULE`.

    Nothing that it accepts leaves the host (``//evil``), climbs (``..``), or needs escaping in a link or a header.
    """
    path = text.removesuffix("/")
    if path and (
        len(path) > LONGEST_PATH
        or not _PATH.fullmatch(path)
        or any(part in (".", "..") for part in path.split("/"))
    ):
        raise ValueError(PATH_RULE)
    return path


def networks(text: str) -> tuple[Network, ...]:
    """IP addresses and networks, separated by commas. Raises ``ValueError``."""
    try:
        return tuple(ipaddress.ip_network(part.strip()) for part in text.split(",") if part.strip())
    except ValueError:
        raise ValueError("IP addresses and networks such as 10.0.0.0/8, separated by commas") from None


class Settings(BaseSettings):
    """All settings, with their defaults; each is read from ``SAFESTART_<NAME>`` or the file."""

    model_config = SettingsConfigDict(env_prefix=PREFIX, extra="forbid", frozen=True)

    database_url: str = Field("", description="SQLAlchemy URL; empty: one SQLite file in the data directory.")
    database_password_file: str = Field(
        "", description="File that holds the password of a PostgreSQL URL without one."
    )
    host: str = Field("127.0.0.1", description="Address the service binds to.")
    port: int = Field(8000, ge=0, le=65535, description="Port the service binds to.")
    scheduler: str = Field("", description="Address of a Dask scheduler; empty: an embedded LocalCluster.")
    processes: int = Field(
        default_factory=lambda: os.cpu_count() or 1,
        ge=1,
        le=1024,
        description="Task processes of the embedded cluster.",
    )
    warm_up: Literal["all", "needed"] = Field(
        "all",
        description="What a worker compiles or loads after its start; all: all kernels, so that no later job waits for "
        "them; needed: those that the next job needs, which spares a small machine some 20 s of processor time.",
    )
    lease_s: float = Field(20.0, ge=1, le=600, description="How long a claim holds without renewal, s.")
    poll_s: float = Field(0.2, ge=0.02, le=60, description="How often the worker looks for work, s.")
    job_timeout_s: float = Field(3600.0, ge=1, le=604800, description="Longest run of a job, s.")
    max_attempts: int = Field(3, ge=1, le=100, description="Attempts after which a job counts as poison.")
    silence_s: float = Field(
        60.0,
        ge=1,
        le=3600,
        description="A job that reports nothing and uses no processor for this long, s, starts again.",
    )
    keep_days: float = Field(
        0.0, ge=0, le=36500, description="Days after which the worker deletes ended jobs; 0: never."
    )
    log_format: Literal["text", "json"] = Field(
        "text", description="Logs as text or as one JSON object per line."
    )
    max_body_bytes: int = Field(8_000_000, ge=1000, description="Largest request body the service reads.")
    max_states: int = Field(100_000, ge=1, description="Most states in one go-no-go request.")
    max_queued: int = Field(10_000, ge=1, description="Most jobs waiting at once.")
    allowed_hosts: str = Field(
        "",
        description="Host names, separated by commas, that the service accepts besides localhost and IP addresses.",
    )
    root_path: str = Field(
        "", description="Path below which clients find the service, such as /safestart; empty: none."
    )
    trusted_proxies: str = Field(
        "127.0.0.0/8, ::1",
        description="Addresses and networks of proxies, separated by commas, whose X-Forwarded-For, -Proto, -Host and "
        "-Prefix count; empty: none.",
    )
    rate_per_s: float = Field(
        1000.0, gt=0, description="Requests per second of one API key; bursts of 10 s' worth."
    )
    submit_rate_per_s: float = Field(
        50.0, gt=0, description="Submissions and dismissals per second of one API key; bursts of 10 s' worth."
    )
    request_timeout_s: float = Field(
        60.0, ge=1, le=3600, description="Longest time a request's body may take to arrive, s."
    )

    answer_timeout_s: float = Field(
        30.0, ge=1, le=3600, description="Longest time that a client waits for an answer at once, s."
    )
    answer_processes: int = Field(
        default_factory=lambda: min(max(2, os.cpu_count() or 1), 4),
        ge=1,
        le=64,
        description="Helper processes of the service that compute heavy answers.",
    )
    max_bodies_bytes: int = Field(
        96_000_000, ge=1000, description="Most bytes of all request bodies in flight together."
    )
    max_answers_bytes: int = Field(
        192_000_000,
        ge=1000,
        description="Most bytes of all long answers together that their clients have not read yet; one API key may "
        "hold half of them. One answer alone may be longer.",
    )
    max_connections: int = Field(
        800,
        ge=2,
        le=100_000,
        description="Most open connections; one address other than this machine's own may hold half of them.",
    )
    max_followers: int = Field(
        400,
        ge=2,
        le=100_000,
        description="Most event streams and long polls at once; one API key may hold half of them.",
    )

    @field_validator("root_path")
    @classmethod
    def _path(cls, value: str) -> str:
        return path_below(value)

    @field_validator("trusted_proxies")
    @classmethod
    def _networks(cls, value: str) -> str:
        networks(value)
        return value

    @classmethod
    def settings_customise_sources(
        cls,
        settings_cls: type[BaseSettings],
        init_settings: PydanticBaseSettingsSource,
        env_settings: PydanticBaseSettingsSource,
        dotenv_settings: PydanticBaseSettingsSource,
        file_secret_settings: PydanticBaseSettingsSource,
    ) -> tuple[PydanticBaseSettingsSource, ...]:
        """Arguments first, then the environment, then the file."""
        return init_settings, of_variables(settings_cls), of_file(settings_cls)

    def url(self) -> str:
        """The database URL with its password; creates the default directory if it is missing."""
        if self.database_url:
            return with_password(self.database_url, self.database_password_file)
        folder = place(user_data_path)
        try:
            if folder is None:
                raise FileNotFoundError(ENOENT, "this account has no home directory")
            folder.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            required = "a setting SAFESTART_DATABASE_URL, or a data directory that can be made"
            received = error.strerror if folder is None else f"{folder} ({error.strerror})"
            raise InvalidInput(
                f"database_url: required {required}, received {received}",
                field="database_url",
                required=required,
                received=received,
            ) from None
        return f"sqlite:///{folder / 'safestart.sqlite3'}"


def url_or_setting(given: str | None) -> str:
    """The database URL that a command was given, else that of the settings, all of which are read and checked."""
    chosen = settings()
    return given or chosen.url()


@cache
def settings() -> Settings:
    """The process-wide settings; raises ``InvalidInput`` and names the wrong setting."""
    require_known(os.environ)
    try:
        return Settings()  # type: ignore[call-arg, unused-ignore]
    except ValidationError as error:
        raise refusal([_fit(report) for report in error.errors(include_url=False)], "settings.") from None


def _fit(report: Any) -> dict[str, Any]:
    """A pydantic report that hides the contents of tables and arrays."""
    fit = dict(report)
    if isinstance(fit.get("input"), dict | list):  # it may contain a URL with its password
        fit["input"] = type(fit["input"])
    return fit
