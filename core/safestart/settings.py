"""Settings of every part: ``SAFESTART_*`` variables, or a TOML file named by ``SAFESTART_CONFIG``."""

from __future__ import annotations

import os
from functools import cache
from pathlib import Path
from typing import Literal

from platformdirs import user_config_path, user_data_path
from pydantic import Field, ValidationError
from pydantic_settings import (
    BaseSettings,
    PydanticBaseSettingsSource,
    SettingsConfigDict,
    TomlConfigSettingsSource,
)

from safestart.validation import validation_error


class Settings(BaseSettings):
    """All settings, with their defaults; each is read from ``SAFESTART_<NAME>`` or the file."""

    model_config = SettingsConfigDict(env_prefix="SAFESTART_", extra="forbid", frozen=True)

    database_url: str = Field("", description="SQLAlchemy URL; empty: one SQLite file in the data directory.")
    host: str = Field("127.0.0.1", description="Address the service binds to.")
    port: int = Field(8000, ge=0, le=65535, description="Port the service binds to.")
    scheduler: str = Field("", description="Address of a Dask scheduler; empty: an embedded LocalCluster.")
    processes: int = Field(
        default_factory=lambda: os.cpu_count() or 1,
        ge=1,
        le=1024,
        description="Task processes of the embedded cluster.",
    )
    lease_s: float = Field(20.0, ge=1, le=600, description="How long a claim holds without renewal, s.")
    poll_s: float = Field(0.2, ge=0.02, le=60, description="How often the worker looks for work, s.")
    job_timeout_s: float = Field(3600.0, ge=1, le=604800, description="Longest run of a job, s.")
    max_attempts: int = Field(3, ge=1, le=100, description="Attempts after which a job counts as poison.")
    silence_s: float = Field(
        60.0,
        ge=1,
        le=3600,
        description="A job that reports nothing and uses no processor for that long, s, starts again.",
    )
    keep_days: float = Field(
        0.0, ge=0, le=36500, description="Days after which the worker deletes ended jobs; 0: they are kept."
    )
    log_format: Literal["text", "json"] = Field(
        "text", description="Logs as text or as one JSON object a line."
    )
    max_body_bytes: int = Field(8_000_000, ge=1000, description="Largest request body the service reads.")
    max_states: int = Field(100_000, ge=1, description="Most states in one go-no-go request.")
    max_queued: int = Field(10_000, ge=1, description="Most jobs waiting at once.")
    allowed_hosts: str = Field(
        "",
        description="Host names, separated by commas, under which the service may be asked for, besides localhost "
        "and IP addresses.",
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
        path = Path(os.environ.get("SAFESTART_CONFIG") or user_config_path("safestart") / "safestart.toml")
        return init_settings, env_settings, TomlConfigSettingsSource(settings_cls, toml_file=path)

    def url(self) -> str:
        """The database URL; the default directory is made when it is not there."""
        if self.database_url:
            return self.database_url
        folder = user_data_path("safestart")
        folder.mkdir(parents=True, exist_ok=True)
        return f"sqlite:///{folder / 'safestart.sqlite3'}"


@cache
def settings() -> Settings:
    """The process-wide settings; raises ``InvalidInput`` that names the wrong setting."""
    try:
        return Settings()  # type: ignore[call-arg, unused-ignore]
    except ValidationError as error:
        raise validation_error(error, prefix="settings.") from None
