"""No text of a message starts a line of its own: whoever names a craft states nothing else."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

from safestart.cli import build
from safestart.errors import InvalidInput
from safestart.interchange.ccsds import kvn, oem, xml_out
from safestart.interchange.ccsds.tokens import Kind, Token
from safestart.interchange.epochs import require_epoch
from safestart.interchange.read import ephemeris_from
from safestart.interchange.write import course_bytes
from safestart.processes.registry import process
from tests.unit.interchange.sample import CREATED, course, turning

FORGED = "x\nORIGINATOR = NASA"
NO_LINES = [FORGED, "a\rb", "a\x1b[2Jb", "a\x85b", "a\u2028b", "a\u202eb", "a\tb", "a\x00b", "a\ud800b"]
NO_EPOCHS = [
    "bogus",
    FORGED,
    f"{CREATED}\nORIGINATOR = NASA",
    "2026-02-30T00:00:00",
    "2026-01-01T24:00:00",
    "",
]


@pytest.mark.parametrize("text", NO_EPOCHS, ids=repr)
@pytest.mark.parametrize("form", ["kvn", "xml"])
def test_a_message_is_created_at_an_epoch(text: str, form: str, tmp_path: Path) -> None:
    for given in (course(), turning()):
        with pytest.raises(InvalidInput, match=r"^CREATION_DATE: required"):
            course_bytes(given, form, text)
    source, goal = tmp_path / "a.oem", tmp_path / f"b.{'oem' if form == 'kvn' else form}"
    source.write_bytes(course_bytes(course(), "kvn", CREATED))
    found = CliRunner().invoke(build(), ["convert", str(source), str(goal), "--created", text])
    assert isinstance(found.exception, InvalidInput)
    assert found.exception.field == "--created"
    assert not goal.exists()


@pytest.mark.parametrize("text", ["2026-01-01T00:00:00.5Z", "2026-001T00:00:00", "2016-12-31T23:59:60"])
def test_epochs_that_are_some(text: str) -> None:
    require_epoch("CREATION_DATE", text)
    assert f"CREATION_DATE = {text}\n".encode() in course_bytes(course(), "kvn", text)


@pytest.mark.parametrize("text", NO_LINES, ids=repr)
def test_names_are_one_line(text: str) -> None:
    for given, names in ((course(), ("name", "object_id")), (turning(), ("name", "object_id", "body"))):
        for name in names:
            with pytest.raises(InvalidInput, match="required one line of text"):
                replace(given, **{name: text})  # type: ignore[type-var]


@pytest.mark.parametrize("text", NO_LINES, ids=repr)
@pytest.mark.parametrize("write", [kvn.text_of, xml_out.text_of])
def test_no_token_writes_a_line_of_its_own(text: str, write: Any) -> None:
    head = oem.tokens_of(course(), CREATED)
    write(head)
    wrong = (
        Token(Kind.KEY, "ORIGINATOR", text),
        Token(Kind.KEY, "X", "1", text),
        Token(Kind.ROW, value=text),
    )
    for token in wrong:
        with pytest.raises(InvalidInput, match="required one line of text"):
            write([*head, token])
    with pytest.raises(InvalidInput, match="required one line of text"):
        write(oem.tokens_of(course(), CREATED, text))


def test_a_file_with_such_a_name_is_refused() -> None:
    xml = course_bytes(course(), "xml", CREATED).decode()
    name = course().name
    with pytest.raises(InvalidInput, match="OBJECT_NAME: required one line of text"):
        ephemeris_from(xml.replace(f">{name}<", f">{name}\nORIGINATOR = NASA<").encode())
    table = course_bytes(course(), "csv", CREATED).decode()
    with pytest.raises(InvalidInput, match=r"object: |OBJECT_NAME: required one line of text"):
        ephemeris_from(table.replace(name, f"{name}\x1b").encode(), "a.csv")


def test_over_http_too() -> None:
    """Its text is an input of a process; a service asks `possible` before it queues."""
    spec = process("commit-timeline")
    lines = spec.example["chaser"].splitlines()
    named = [f"{line}\x1b[2J" if line.startswith("OBJECT_NAME") else line for line in lines]
    asked = spec.parse(spec.example | {"chaser": "\n".join(named)})
    with pytest.raises(InvalidInput, match="OBJECT_NAME: required one line of text"):
        spec.require_possible(asked)
