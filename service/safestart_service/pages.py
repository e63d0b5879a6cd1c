"""Pages rendered on the server: no script, one style sheet of ours, nothing from elsewhere."""

from __future__ import annotations

import json
from datetime import UTC, datetime
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fastapi.responses import HTMLResponse, Response
from starlette.exceptions import HTTPException

from safestart_service.tables import api_operations, split_outputs

if TYPE_CHECKING:
    from jinja2 import Environment

_HERE = Path(__file__).parent
_STATIC = {"safestart.css": "text/css", "safestart.svg": "image/svg+xml"}
_MAX_INPUTS = 4000
ACTIVE = ("accepted", "running")
REFRESH_S = 3


@cache
def _environment() -> Environment:
    # Imported with the first page: the API starts without.
    from jinja2 import Environment, FileSystemLoader, StrictUndefined

    environment = Environment(
        loader=FileSystemLoader(_HERE / "templates"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters.update(figure=figure, duration=duration, moment=moment)
    return environment


def _page(template: str, **values: Any) -> HTMLResponse:
    text = _environment().get_template(template).render(**values)
    return HTMLResponse(text, headers={"Cache-Control": "no-store"})


def job_list(
    jobs: list[dict[str, Any]], counts: dict[str, int], workers: int, next_cursor: str | None, root: str
) -> Response:
    """The page of all jobs."""
    busy = any(counts.get(status) for status in ACTIVE)
    refresh = REFRESH_S if busy else None
    return _page(
        "jobs.html", root=root, jobs=jobs, counts=counts, workers=workers, cursor=next_cursor, refresh=refresh
    )


def job(detail: dict[str, Any], result: dict[str, Any] | None, root: str) -> Response:
    """The page of one job."""
    refresh = REFRESH_S if detail["status"] in ACTIVE else None
    pictures: list[dict[str, Any]] = []
    if result is not None:
        pictures = [a for a in result["artifacts"] if a["media_type"] in ("image/png", "image/jpeg")]
    outputs = split_outputs(result["outputs"]) if result is not None else None
    return _page(
        "job.html",
        root=root,
        job=detail,
        result=result,
        outputs=outputs,
        pictures=pictures,
        inputs=_shown_inputs(detail["inputs"]),
        refresh=refresh,
    )


def _shown_inputs(inputs: dict[str, Any]) -> str:
    text = json.dumps(inputs, indent=2)
    return text if len(text) <= _MAX_INPUTS else text[:_MAX_INPUTS] + "\n… the rest is in the JSON document"


def docs(description: dict[str, Any], root: str) -> Response:
    """The API description as a page."""
    return _page(
        "docs.html", root=root, info=description["info"], groups=api_operations(description), refresh=None
    )


def static(name: str) -> Response:
    """A static file of ours."""
    if name not in _STATIC:
        raise HTTPException(404)
    data = (_HERE / "static" / name).read_bytes()
    return Response(data, media_type=_STATIC[name], headers={"Cache-Control": "public, max-age=300"})


def figure(value: Any) -> str:
    """A value for a table cell: numbers to five figures, None as a dash."""
    if value is None:
        return "–"
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, float):
        return f"{value:.5g}"
    if isinstance(value, list):
        return ", ".join(figure(item) for item in value)
    return str(value)


def duration(seconds: float | None) -> str:
    """Seconds as people say them."""
    if seconds is None:
        return "–"
    if seconds < 90:
        return f"{seconds:.0f} s" if seconds >= 10 else f"{seconds:.1f} s"
    if seconds < 5400:
        return f"{seconds / 60:.0f} min"
    return f"{seconds / 3600:.1f} h"


def moment(when: datetime | None) -> str:
    """A time in UTC, to the second."""
    return "–" if when is None else when.astimezone(UTC).strftime("%Y-%m-%d %H:%M:%S UTC")
