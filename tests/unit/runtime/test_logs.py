"""Logs: one line per event, whatever text of others stands in it."""

from __future__ import annotations

import json
import logging

import pytest

from safestart.runtime.logs import JsonLines, TextLines, about

FORGED = "/x\n2026-01-01 00:00:00.000+00:00 INFO safestart.service all is well\r\x1b[2J\u2028"


def record(message: str, **more: object) -> logging.LogRecord:
    made = logging.LogRecord("safestart.service", logging.ERROR, __file__, 1, message, (), None)
    made.__dict__.update(about(request="r-1"), **more)
    return made


@pytest.mark.parametrize("form", [TextLines(), JsonLines()])
def test_a_message_is_one_line(form):
    text = form.format(record(FORGED))
    assert len(text.splitlines()) == 1
    assert "\x1b" not in text
    assert "r-1" in text


def test_what_is_printable_stays_as_it_is():
    assert (
        TextLines()
        .format(record("größer als 3 µm: 'a b'"))
        .endswith("ERROR safestart.service request=r-1 größer als 3 µm: 'a b'")
    )
    assert json.loads(JsonLines().format(record("größer")))["message"] == "größer"
