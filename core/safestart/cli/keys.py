"""``safestart keys``: make, list and revoke API keys, and read the audit log, in the database itself."""

from __future__ import annotations

import getpass
from collections.abc import Iterator
from contextlib import contextmanager
from datetime import datetime
from typing import TYPE_CHECKING, Annotated, Any

import typer
from rich.markup import escape

from safestart.cli.console import Json, err, out, print_json, table_of
from safestart.runtime.access import Caller, Role

if TYPE_CHECKING:
    from safestart.store.database import Database
    from safestart.store.records import ApiKey

Url = Annotated[str | None, typer.Option("--database-url", help="SQLAlchemy URL; absent: the setting.")]


def register(app: typer.Typer) -> None:
    """Add the group."""
    group = typer.Typer(help="API keys and the audit log.", no_args_is_help=True)
    group.command("create")(create)
    group.command("list")(list_keys)
    group.command("revoke")(revoke)
    group.command("audit")(audit)
    app.add_typer(group, name="keys")


def create(
    name: Annotated[str, typer.Option(help="Who or what uses the key.")],
    role: Annotated[
        Role, typer.Option(help="read; submit, which includes read; admin, which includes all.")
    ] = Role.READ,
    days: Annotated[float, typer.Option(help="Days until it expires; 0: never.")] = 90.0,
    database_url: Url = None,
    as_json: Json = False,
) -> None:
    """Make a key and show it, this once. From the first key on, every call needs one."""
    from safestart.cli.streams import require_delivered, require_open
    from safestart.store.access.keys import KeyRepository

    def show(record: ApiKey, key: str) -> None:
        if as_json:
            print_json({**_document(record), "key": key})
        else:  # only the key on standard output, so that it can be piped into a file or a secret store
            out.print(key, soft_wrap=True, highlight=False)
        require_delivered("no key was made")

    require_open("no key was made")
    with _database(database_url) as database:
        record, _ = KeyRepository(database).create(name, role, None if days == 0 else days, operator(), show)
    if as_json:
        return
    until = "never expires" if record.expires_at is None else f"expires {_moment(record.expires_at)}"
    err.print(
        f"key {record.id} ({record.name}, {record.role.value}, {until}); it is not shown again",
        soft_wrap=True,
    )


def list_keys(database_url: Url = None, as_json: Json = False) -> None:
    """All keys ever made, without their secrets."""
    from safestart.store.access.keys import KeyRepository

    with _database(database_url) as database:
        found = KeyRepository(database).list()
    if as_json:
        print_json({"keys": [_document(key) for key in found]})
        return
    columns = ("id", "name", "role", "state", "created", "expires", "last used")
    shown = table_of("keys", [(column, "left") for column in columns])
    for key in found:
        times = (_moment(when) for when in (key.created_at, key.expires_at, key.last_used_at))
        shown.add_row(key.id, escape(key.name), key.role.value, _state(key), *times)
    out.print(shown)


def revoke(
    key_id: Annotated[str, typer.Argument(help="Id of the key, as `safestart keys list` shows it.")],
    database_url: Url = None,
    as_json: Json = False,
) -> None:
    """End a key for good; a running service follows within about a second."""
    from safestart.store.access.keys import KeyRepository

    with _database(database_url) as database:
        record = KeyRepository(database).revoke(key_id, operator())
    if as_json:
        print_json(_document(record))
    else:
        err.print(f"key {record.id} ({record.name}) is revoked")


def audit(
    subject: Annotated[str | None, typer.Option(help="Only about this job or key.")] = None,
    key_id: Annotated[str | None, typer.Option("--key", help="Only by this key.")] = None,
    limit: Annotated[int, typer.Option(min=1, max=1000, help="Entries, newest first.")] = 50,
    database_url: Url = None,
    as_json: Json = False,
) -> None:
    """Who submitted and dismissed which job, made and revoked which key."""
    from safestart.store.access.audit import AuditLog

    with _database(database_url) as database:
        page = AuditLog(database).entries(subject=subject, key_id=key_id, limit=limit)
    if as_json:
        names = ("id", "action", "subject", "key_id", "actor", "address", "request_id", "detail")
        entries = [
            {"at": entry.at.isoformat(), **{name: getattr(entry, name) for name in names}}
            for entry in page.entries
        ]
        print_json({"entries": entries, "next_before": page.next_before})
        return
    shown = table_of(
        "audit log", [(name, "left") for name in ("at", "action", "subject", "key", "by", "from")]
    )
    for entry in page.entries:
        shown.add_row(
            _moment(entry.at),
            entry.action,
            entry.subject,
            entry.key_id or "-",
            escape(entry.actor),
            escape(entry.address or "-"),
        )
    out.print(shown)


@contextmanager
def _database(url: str | None) -> Iterator[Database]:
    from safestart.runtime.settings import url_or_setting
    from safestart.store.database import Database

    database = Database(url_or_setting(url))
    try:
        database.migrate()
        yield database
    finally:
        database.close()


def operator() -> Caller:
    """The caller beside the database: only the account's name is known."""
    try:
        name = f"cli:{getpass.getuser()}"
    except (KeyError, OSError):
        name = "cli"
    return Caller(None, name, Role.ADMIN)


def _state(key: ApiKey) -> str:
    if key.revoked_at is not None:
        return "revoked"
    return "in force" if key.usable else "expired"


def _moment(when: datetime | None) -> str:
    return "-" if when is None else when.strftime("%Y-%m-%d %H:%M")


def _document(key: ApiKey) -> dict[str, Any]:
    times = {
        "created": key.created_at,
        "expires": key.expires_at,
        "revoked": key.revoked_at,
        "last_used": key.last_used_at,
    }
    return {
        "id": key.id,
        "name": key.name,
        "role": key.role.value,
        **{name: None if when is None else when.isoformat() for name, when in times.items()},
        "usable": key.usable,
    }
