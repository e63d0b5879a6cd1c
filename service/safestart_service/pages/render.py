"""Pages: the server renders shells, and our own small scripts fill them from the public API; nothing comes from
elsewhere.

A page holds no data of the store, so anyone may get it; its script requests the data, with a key if keys are
required.
"""

from __future__ import annotations

import re
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fastapi import Request
from fastapi.responses import HTMLResponse, Response
from starlette.exceptions import HTTPException

from safestart_service.http.answers import Shared, all_lines, entity_tag, not_modified
from safestart_service.pages.openapi_operations import api_operations

if TYPE_CHECKING:
    from jinja2 import Environment
    from markupsafe import Markup

_HERE = Path(__file__).parents[1]
_TYPES = {".css": "text/css", ".svg": "image/svg+xml", ".js": "text/javascript"}
_PLOTLY = "plotly.min.js"
# The pages in the order of the menu: path, name, what a lost visitor finds there.
PAGES = (
    ("/dashboard", "Explore", "may the chaser start here?"),
    ("/dashboard/space", "In space", "any start, tumble, orbit and corridor"),
    ("/dashboard/trade", "Trade study", "which tumble and thrust are enough?"),
    ("/dashboard/approach", "Approach designer", "hops to the target, and burns that are missed"),
    ("/dashboard/submit", "Submit", "any process, by a form"),
    ("/dashboard/jobs", "Jobs", "what runs, and what came out"),
    ("/docs", "API", "every call"),
)
# Hashes of the three style attributes that plotly.js writes as text; it sets all other styles through the DOM.
_PLOTLY_STYLES = (
    "'sha256-ji27qzEtxXZW+7dun6UwjHXJ18e6WAin1VvNtkzIE/o='",
    "'sha256-47DEQpj8HBSa+/TImW+5JCeuQeRkm5NMpJWZG3hSuFU='",
    "'sha256-AR/cKIZjWPcPmBUPDA6oti9XBiTbJvz0Cro2J1VzzS8='",
)
CSP = (
    "default-src 'none'; script-src 'self'; connect-src 'self'; img-src 'self' data: blob:; "
    f"style-src 'self' 'unsafe-hashes' {' '.join(_PLOTLY_STYLES)}; "
    "base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
)


@cache
def _environment() -> Environment:
    # Imported with the first page, so that the API starts without it.
    from jinja2 import Environment, FileSystemLoader, StrictUndefined

    found = Environment(
        loader=FileSystemLoader(_HERE / "templates"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    found.filters["coded"] = coded
    found.globals["pages"] = PAGES
    return found


def coded(text: str) -> Markup:
    """A text of the API description, what stands between backticks as code."""
    from markupsafe import Markup, escape

    code = Markup("<code>{}</code>")
    parts = re.split(r"`+([^`]+)`+", str(text))
    return Markup("").join(code.format(part) if k % 2 else escape(part) for k, part in enumerate(parts))


def page(template: str, *, status: int = 200, **values: Any) -> HTMLResponse:
    """A page; ``here`` is its path, ``root`` the mount path, ``script`` its module, ``plots`` whether it draws."""
    text = _environment().get_template(template).render(**values)
    return HTMLResponse(text, status, headers={"Cache-Control": "no-store", "Content-Security-Policy": CSP})


def docs(description: dict[str, Any], root: str) -> Response:
    """The API description as an HTML page."""
    groups = api_operations(description)
    return page("docs.html", root=root, here="/docs", info=description["info"], groups=groups)


def wanted(request: Request) -> bool:
    """Whether a browser asks for a page, not a program for a document."""
    return request.method in ("GET", "HEAD") and "text/html" in (all_lines(request, "accept") or "")


def missing(request: Request, root: str) -> HTMLResponse:
    """The page for a browser at a path where nothing is."""
    return page("missing.html", status=404, root=root, here="", path=request.scope["path"])


@cache
def _static_file(name: str) -> tuple[bytes, str, str]:
    """Bytes, media type and entity tag of one of our files, or of plotly.js."""
    from hashlib import sha256

    path = files("plotly") / "package_data" / name if name == _PLOTLY else _HERE / "static" / name
    data = path.read_bytes()
    return data, _TYPES[Path(name).suffix], entity_tag(sha256(data).hexdigest())


@cache
def _names() -> frozenset[str]:
    here = _HERE / "static"
    found = (path.relative_to(here).as_posix() for path in here.rglob("*") if path.suffix in _TYPES)
    return frozenset(found) | {_PLOTLY}


def static(request: Request, name: str) -> Response:
    """A script, style sheet or picture of the pages."""
    if name not in _names():
        raise HTTPException(404)
    data, media_type, tag = _static_file(name)
    # Browsers ask each time and get a 304, so that no page runs an old script after an upgrade.
    headers = {"Cache-Control": "no-cache", "ETag": tag}
    return not_modified(request, tag) or Shared(data, media_type=media_type, headers=headers)
