"""The words of the descriptions and pages: works by their authors, what people know instead of what we call it."""

from __future__ import annotations

import re
from collections.abc import Iterator
from html.parser import HTMLParser
from typing import Any

import pytest

from safestart.processes.registry import PROCESS_IDS

PAGES = ("", "/trade", "/submit", "/jobs", "/jobs/some-job", "/compare")


def texts(node: Any) -> Iterator[str]:
    if isinstance(node, dict):
        node = list(node.values())
    for item in node if isinstance(node, list) else ():
        yield from texts(item)
    if isinstance(node, str):
        yield node


class Text(HTMLParser):
    """The text of a page outside of code."""

    def __init__(self) -> None:
        super().__init__()
        self.open, self.found = 0, list[str]()

    def handle_starttag(self, tag: str, attrs: object) -> None:
        self.open += tag in ("code", "pre")

    def handle_endtag(self, tag: str) -> None:
        self.open -= tag in ("code", "pre")

    def handle_data(self, data: str) -> None:
        if not self.open:
            self.found.append(data)


def visible(page: str) -> str:
    reader = Text()
    reader.feed(page)
    return " ".join(reader.found)


def test_no_work_is_a_number(client):
    said = [*texts(client.get("/openapi.json").json())]
    said += [text for name in PROCESS_IDS for text in texts(client.get(f"/processes/{name}").json())]
    assert [text for text in said if re.search(r"paper 00\d", text, re.IGNORECASE)] == []


def test_no_backtick_is_left_on_the_page_of_the_api(client):
    page = visible(client.get("/docs").text)
    assert "Accept" in page, "it was read"
    assert [page[max(0, k - 60) : k + 60] for k in [m.start() for m in re.finditer("`", page)]] == []


@pytest.mark.parametrize("path", PAGES)
def test_pages_say_what_people_say(client, path):
    page = visible(client.get(f"/dashboard{path}").text)
    assert len(page) > 40
    for word in (r"\bshards?\b", r"\bdismiss", r"paper 00\d", r"\bAsk\b", "`"):
        assert re.search(word, page) is None, word
