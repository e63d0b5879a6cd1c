"""The page inside a bundle: a finished job to read in a browser, from its own folder, without a script."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from html import escape
from typing import Any

from safestart.artifact import Artifact

_STYLE = (
    "body{font:15px/1.5 system-ui,sans-serif;max-width:70em;margin:2em auto;padding:0 1em;color:#1b2530}"
    "table{border-collapse:collapse;margin:.5em 0}td,th{border:1px solid #c8d0d8;padding:.2em .6em;text-align:left;"
    "vertical-align:top}th{background:#eef2f5;font-weight:600}img{max-width:100%}code{word-break:break-all}"
)
_MOST_ROWS, _MOST_TEXT = 200, 300


def page(
    job: Mapping[str, Any],
    result: Mapping[str, Any] | None,
    events: Sequence[Mapping[str, Any]],
    artifacts: Sequence[Artifact],
) -> str:
    """HTML of one job: facts, outputs, pictures, inputs, provenance, events."""
    facts = {name: value for name, value in job.items() if name not in ("inputs", "instant", "versions")}
    parts = [f"<h1>Job {escape(str(job['id']))}</h1>", _table(facts)]
    if result is not None:
        parts += ["<h2>Outputs</h2>", _value(result["outputs"])]
    for item in artifacts:
        where = f"artifacts/{escape(item.name, quote=True)}"
        shown = (
            f'<img src="{where}" alt="{escape(item.name, quote=True)}">'
            if item.media_type == "image/png"
            else ""
        )
        parts.append(f'<p><a href="{where}">{escape(item.name)}</a> ({len(item.data)} bytes)</p>{shown}')
    parts += ["<h2>Inputs</h2>", _value(job["inputs"])]
    if result is not None:
        parts += ["<h2>Provenance</h2>", _value(result.get("provenance", {}))]
    parts += ["<h2>Events</h2>", _value(list(events))]
    title = f"safestart job {escape(str(job['id']))}"
    head = f'<meta charset="utf-8"><title>{title}</title><style>{_STYLE}</style>'
    return f'<!doctype html><html lang="en"><head>{head}</head><body>{"".join(parts)}</body></html>\n'


def _value(value: Any) -> str:
    if isinstance(value, Mapping):
        return _table(value)
    if isinstance(value, list) and value and all(isinstance(item, Mapping) for item in value):
        return _rows(value)
    return _scalar(value)


def _table(mapping: Mapping[str, Any]) -> str:
    rows = "".join(
        f"<tr><th>{escape(str(name))}</th><td>{_value(value)}</td></tr>" for name, value in mapping.items()
    )
    return f"<table>{rows}</table>" if rows else "–"


def _rows(rows: Sequence[Mapping[str, Any]]) -> str:
    names = list(dict.fromkeys(name for row in rows[:_MOST_ROWS] for name in row))
    head = "".join(f"<th>{escape(str(name))}</th>" for name in names)
    body = "".join(
        "<tr>" + "".join(f"<td>{_value(row.get(name))}</td>" for name in names) + "</tr>"
        for row in rows[:_MOST_ROWS]
    )
    more = f"<p>{len(rows) - _MOST_ROWS} more in the JSON.</p>" if len(rows) > _MOST_ROWS else ""
    return f"<table><tr>{head}</tr>{body}</table>{more}"


def _scalar(value: Any) -> str:
    if value is None:
        return "–"
    text = f"{value:.6g}" if isinstance(value, float) else str(value)
    if len(text) > _MOST_TEXT:
        text = text[:_MOST_TEXT] + " … (the rest is in the JSON)"
    return escape(text)
