"""Where settings are read: variables of the environment, and one TOML file, both more strictly than Pydantic would."""

from __future__ import annotations

import os
import tomllib
from collections.abc import Callable, Mapping
from difflib import get_close_matches
from pathlib import Path
from typing import Any

from platformdirs import user_config_path
from pydantic_settings import BaseSettings, InitSettingsSource

from safestart.errors import invalid
from safestart.model.plain_numbers import is_number, require_plain
from safestart.runtime.files.bounded import bytes_within
from safestart.runtime.variables import NAMES, PREFIX

_MOST_FILE_BYTES = 1024 * 1024


def of_variables(kind: type[BaseSettings]) -> InitSettingsSource:
    """Read the variables by their exact names; raises ``InvalidInput`` for numbers that a query refuses, too.

    Pydantic would read ``safestart_port`` beside ``SAFESTART_PORT``, and ``8_000`` or ``" 8000"`` as a number.
    """
    given = {name: os.environ[PREFIX + name.upper()] for name in NAMES if PREFIX + name.upper() in os.environ}
    for name, value in given.items():
        if is_number(kind.model_fields[name].annotation):
            require_plain(f"settings.{name}", value)
    return InitSettingsSource(kind, init_kwargs=given)


def of_file(kind: type[BaseSettings]) -> InitSettingsSource:
    """Read the settings file; raises ``InvalidInput`` when a named file is missing or is not TOML."""
    named = os.environ.get("SAFESTART_CONFIG")
    folder = place(user_config_path)
    path = Path(named) if named else folder / "safestart.toml" if folder else None
    if named and not os.path.isfile(named):  # Path raises on a name that is too long
        raise invalid("SAFESTART_CONFIG", "the path of a TOML file", named)
    try:
        given = tomllib.loads(_read(path)) if path is not None and path.is_file() else {}
    except RecursionError:
        raise invalid(str(path), "a readable TOML file in UTF-8", "one nested too deeply") from None
    except (OSError, ValueError) as error:  # invalid TOML or UTF-8 is a ValueError
        raise invalid(str(path), "a readable TOML file in UTF-8", str(error)) from None
    _require_names(kind, given)
    _require_kinds(kind, given)
    return InitSettingsSource(kind, init_kwargs=given)


def _read(path: Path) -> str:
    return bytes_within(str(path), path, _MOST_FILE_BYTES).decode()


def _require_names(kind: type[BaseSettings], given: Mapping[str, Any]) -> None:
    """Raise ``InvalidInput`` for a name that is not exactly a setting's: beside ``port``, ``Port`` would be ignored."""
    for name in given:
        if name not in kind.model_fields:
            near = get_close_matches(name.lower(), kind.model_fields, n=1)
            like = f", such as {near[0]}" if near else ""
            raise invalid(f"settings.{name}", f"the name of a setting{like} (docs/settings.md)", name)


_KINDS: dict[Any, str] = {int: "an integer", float: "a number", bool: "true or false"}


def _require_kinds(kind: type[BaseSettings], given: Mapping[str, Any]) -> None:
    """Raise ``InvalidInput`` where a file has a text or a boolean for a number: TOML, unlike a variable, has all three.

    Pydantic, which also reads variables, would take them: ``port = true`` was port 1.
    """
    for name, field in kind.model_fields.items():
        required, value = _KINDS.get(field.annotation), given.get(name)
        if required and isinstance(value, bool | str) and type(value) is not field.annotation:
            raise invalid(f"settings.{name}", required, value)
        if field.annotation is bool and not isinstance(value, bool | None):
            raise invalid(f"settings.{name}", _KINDS[bool], value)


def place(of_user: Callable[[str], Path]) -> Path | None:
    """A folder of the user's; None for an account without a home directory."""
    try:
        return of_user("safestart")
    except RuntimeError:
        return None
