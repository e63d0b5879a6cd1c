"""``safestart replay, label, export, import, backup, restore, purge``: commands on the record of work."""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from safestart.cli.console import Json, err, out, print_json, reporting
from safestart.cli.files import readable, target
from safestart.errors import InvalidInput, invalid

if TYPE_CHECKING:
    from safestart.records.bundle import Bundle
    from safestart.store.database import Database

DatabaseUrl = Annotated[str, typer.Option("--database-url", help="SQLAlchemy URL; empty: the setting.")]
_UNITS = {"s": 1.0, "min": 60.0, "h": 3600.0, "d": 86400.0, "w": 604800.0}


def register(app: typer.Typer) -> None:
    """Add the commands."""
    app.command("replay")(replay)
    app.command("label")(label)
    app.command("export")(export)
    app.command("import")(import_)
    app.command("backup")(backup)
    app.command("restore")(restore)
    app.command("purge")(purge)


def replay(
    job: Annotated[str, typer.Argument(help="Id of a job in the database, or a bundle file.")],
    database_url: DatabaseUrl = "",
    as_json: Json = False,
) -> None:
    """Run a stored job again here and compare. Exit code 0: as promised, 1: different."""
    from safestart.records.replay import replay as run_again

    bundle = _bundle_or_job(job, database_url)
    if bundle.result is None:
        raise InvalidInput(
            f"job {bundle.job['id']} has no result ({bundle.job['status']}); required a successful one"
        )
    with reporting(f"replay {bundle.job['process_id']}") as context:
        found = run_again(bundle.result, {item.name: item.data for item in bundle.artifacts}, context)
    if as_json:
        print_json({"job": bundle.job["id"], **found.document()})
    else:
        promise = "bit for bit" if found.tolerance is None else f"within {found.tolerance:g}"
        out.print(f"{found.verdict} (promised: {promise})")
        for title, lines in (
            ("not as it was", found.environment),
            ("differs", found.differences),
            ("not compared", found.uncompared),
        ):
            for line in lines:
                out.print(f"  {title}: {line}", soft_wrap=True, markup=False)
    raise typer.Exit(0 if found.kept else 1)


def label(
    job: Annotated[str, typer.Argument(help="Id of a job.")],
    name: Annotated[str | None, typer.Option(help="What people call it; empty: no name.")] = None,
    tag: Annotated[list[str] | None, typer.Option(help="A tag, as often as needed: replaces all.")] = None,
    no_tags: Annotated[bool, typer.Option("--no-tags", help="Take all tags away.")] = False,
    note: Annotated[str | None, typer.Option(help="What should be remembered; empty: no note.")] = None,
    database_url: DatabaseUrl = "",
    as_json: Json = False,
) -> None:
    """Write name, tags and note of a job; without options, show them."""
    from safestart.cli.keys import operator
    from safestart.store.jobs.repository import JobRepository

    if no_tags and tag:
        raise InvalidInput("--no-tags: required without --tag, received both", field="--no-tags")
    with _database(database_url) as database:
        tags = [] if no_tags else tag or None
        now = JobRepository(database).label(job, name=name, tags=tags, note=note, by=operator())
    if as_json:
        print_json({"job": now.id, "name": now.name, "tags": now.tags, "note": now.note})
        return
    for title, text in (("name", now.name), ("tags", ", ".join(now.tags)), ("note", now.note)):
        out.print(f"{title}: {text or '–'}", soft_wrap=True, markup=False)


def export(
    job: Annotated[str, typer.Argument(help="Id of a job that has ended.")],
    output: Annotated[Path | None, typer.Option("--output", help="File; absent: JOB.zip here.")] = None,
    crate: Annotated[
        bool, typer.Option("--crate", help="As an RO-Crate, for repositories of research data.")
    ] = False,
    licence: Annotated[
        str | None, typer.Option(help="Address or words of the licence that a crate states.")
    ] = None,
    database_url: DatabaseUrl = "",
) -> None:
    """Write a job as one file that opens without a server (unzip it, open index.html)."""
    from safestart.records.bundle import pack
    from safestart.records.crate import pack_crate

    if licence is not None and not crate:
        raise InvalidInput("--licence: required with --crate, received without", field="--licence")
    path = output or Path(f"{job}.crate.zip" if crate else f"{job}.zip")
    if crate:
        with target("--output", path) as file:
            data = pack_crate(_bundle_of(job, database_url), licence)
            if file is not None:
                file.write(data)
        out.print(f"wrote {path} ({len(data)} bytes)", soft_wrap=True)
        return
    with target("--output", path) as file:
        data, seal = pack(_bundle_of(job, database_url))
        if file is not None:
            file.write(data)
    out.print(f"wrote {path} ({len(data)} bytes), seal {seal}", soft_wrap=True)


def import_(
    bundle: Annotated[Path, typer.Argument(help="A bundle that `safestart export` wrote.")],
    seal: Annotated[str | None, typer.Option(help="The seal that it must have.")] = None,
    database_url: DatabaseUrl = "",
) -> None:
    """Check a bundle and add its job to the database."""
    from safestart.processes.outcome import outcome_of
    from safestart.processes.tables.foreign import require_shape
    from safestart.records.bundle import own_page, unpack
    from safestart.store.transfer import Transfer

    data = _bytes(bundle)
    opened = unpack(data, seal)
    if opened.result is not None:
        require_shape(opened.result, "bundle.result")
    if not own_page(data, opened):
        err.print("its index.html is not the page that this version makes of the job: it was not checked")
    with _database(database_url, new=True) as database:
        outputs = None if opened.result is None else opened.result["outputs"]
        outcome = None if outputs is None else outcome_of(opened.job["process_id"], outputs)
        new = Transfer(database).add(opened, outcome)
    out.print(f"job {opened.job['id']}: {'imported' if new else 'is here already, with the same content'}")


def backup(
    file: Annotated[Path, typer.Argument(help="File to write; it must not exist yet.")],
    database_url: DatabaseUrl = "",
) -> None:
    """Write a consistent copy of the database to one file, while everything runs."""
    from safestart.store.backup import backup as write

    with _database(database_url) as database:
        jobs = write(database, file)
    out.print(f"wrote {file}: {jobs} jobs", soft_wrap=True)


def restore(
    file: Annotated[Path, typer.Argument(help="A file that `safestart backup` wrote.")],
    database_url: DatabaseUrl = "",
) -> None:
    """Fill an empty database from a backup; SQLite or PostgreSQL, whichever it was made from."""
    from safestart.store.backup import restore as fill

    with _database(database_url, new=True) as database:
        jobs = fill(database, file)
        out.print(f"restored {jobs} jobs to {database.shown}", soft_wrap=True)


def purge(
    older_than: Annotated[str, typer.Option(help="Age since their end, such as 30d, 12h, 90min.")],
    dry_run: Annotated[bool, typer.Option("--dry-run", help="Only count.")] = False,
    database_url: DatabaseUrl = "",
) -> None:
    """Delete jobs that ended long ago, with their results, artifacts and events."""
    from safestart.store.jobs.retention import Retention

    seconds = age(older_than)
    with _database(database_url) as database:
        retention = Retention(database)
        number = retention.older(seconds) if dry_run else retention.purge(seconds)
    out.print(f"{number} jobs {'would be deleted' if dry_run else 'deleted'}")


def age(text: str) -> float:
    """Seconds of an age such as ``30d``; raises ``InvalidInput``."""
    match = re.fullmatch(r"([0-9]{1,9}(?:\.[0-9]{1,9})?)(s|min|h|d|w)", text)
    if match is None:
        raise invalid(
            "--older-than", "digits 0 to 9 and s, min, h, d or w, without spaces, such as 30d", text
        )
    return float(match[1]) * _UNITS[match[2]]


def _bundle_or_job(job: str, database_url: str) -> Bundle:
    from safestart.records.bundle import unpack
    from safestart.runtime.settings import settings

    settings()  # wrong ones end every command that may use a database
    return unpack(_bytes(Path(job))) if Path(job).is_file() else _bundle_of(job, database_url)


def _bundle_of(job: str, database_url: str) -> Bundle:
    from safestart.store.transfer import Transfer

    with _database(database_url) as database:
        return Transfer(database).read(job)


@contextmanager
def _database(url: str, *, new: bool = False) -> Iterator[Database]:
    """Open the database; ``new`` creates a missing one, which otherwise counts as a wrong path and is refused."""
    from safestart.runtime.settings import url_or_setting
    from safestart.store.database import Database

    database = Database(url_or_setting(url))
    if database.file is not None and not new and not database.file.exists():
        raise invalid("database_url", "an existing database", database.shown)
    try:
        database.migrate()
        err.print(f"database {database.shown}", soft_wrap=True, markup=False)
        yield database
    finally:
        database.close()


def _bytes(path: Path) -> bytes:
    from safestart.records.bundle import MOST_BYTES
    from safestart.runtime.files.bounded import bytes_within

    with readable("file", path):
        return bytes_within("file", path, MOST_BYTES)
