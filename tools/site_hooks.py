"""Hooks of the documentation site: equations as MathML, links to sources as pages of the site.

Browsers draw MathML themselves: no script, no font, no network.
"""

from __future__ import annotations

import html
import re
from pathlib import Path, PurePosixPath
from typing import Any

from latex2mathml.converter import convert
from mkdocs.exceptions import PluginError
from mkdocs.structure.files import File

ROOT = Path(__file__).resolve().parent.parent
_EQUATION = re.compile(r'<(span|div) class="arithmatex">(\\\(|\\\[)(.*?)(\\\)|\\\])</\1>', re.DOTALL)
_LINK = re.compile(r"\]\(((?:\.\./)+[^)#\s]+)(#[^)\s]*)?\)")


def on_files(files: Any, config: Any) -> Any:
    """Add the sources that pages link to, as text."""
    for page in [one for one in files if one.src_uri.endswith(".md")]:
        text = Path(page.abs_src_path).read_text(encoding="utf-8")
        for match in _LINK.finditer(text):
            source = _outside(page.src_uri, match.group(1))
            if source is not None and files.get_file_from_path(_shown(source)) is None:
                files.append(File.generated(config, _shown(source), content=_read(source, page.src_uri)))
    return files


def on_page_markdown(markdown: str, page: Any, **_: Any) -> str:
    """Point links that leave the documentation at the sources within the site."""
    depth = page.file.src_uri.count("/")

    def replaced(match: re.Match[str]) -> str:
        source = _outside(page.file.src_uri, match.group(1))
        return match.group(0) if source is None else f"]({'../' * depth}{_shown(source)})"

    return _LINK.sub(replaced, markdown)


def on_page_content(content: str, page: Any, **_: Any) -> str:
    """Equations as MathML."""

    def drawn(match: re.Match[str]) -> str:
        block = match.group(1) == "div"
        text = re.sub(r"\\tag\{([^}]*)\}", r"\\qquad(\1)", html.unescape(match.group(3)))
        try:
            return str(convert(text, display="block" if block else "inline"))
        except Exception as error:
            raise PluginError(
                f"{page.file.src_uri}: an equation that cannot be drawn: {text} ({error})"
            ) from error

    return _EQUATION.sub(drawn, content)


def _outside(page: str, link: str) -> str | None:
    """The path in the repository of a link that leaves the documentation; None for one within."""
    parts = list(PurePosixPath("docs", page).parent.parts)
    for step in PurePosixPath(link).parts:
        if step == "..":
            parts.pop()
        else:
            parts.append(step)
    return None if parts[:1] == ["docs"] else "/".join(parts)


def _shown(source: str) -> str:
    return f"source/{source}.txt" if not source.endswith(".json") else f"source/{source}"


def _read(source: str, page: str) -> str:
    place = ROOT / source
    if not place.is_file():
        raise PluginError(f"{page}: a link to {source}, which is not there")
    return place.read_text(encoding="utf-8")
