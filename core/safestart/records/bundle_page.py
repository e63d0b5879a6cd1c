"""The page inside a bundle: shows a finished job in a browser, from its own folder, without a script."""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Mapping, Sequence
from hashlib import sha256
from html import escape
from typing import Any

from safestart.records.artifact import Artifact
from safestart.records.comparable import digest

_STYLE = (
    "body{font:15px/1.5 system-ui,sans-serif;max-width:76em;margin:2em auto;padding:0 1em;color:#1b2530}"
    "h1{margin-bottom:0}h2{margin-top:1.6em}table{border-collapse:collapse;margin:.3em 0}"
    "td,th{border:1px solid #c8d0d8;padding:.2em .6em;text-align:left;vertical-align:top}"
    "th{background:#eef2f5;font-weight:600}.wide{overflow-x:auto}img{max-width:100%}"
    "code{word-break:break-all}figure{margin:1em 0}summary{cursor:pointer;white-space:nowrap}"
    "ul{margin:0;padding-left:1.2em}.number{text-align:right;font-variant-numeric:tabular-nums}"
)
_HASH = b64encode(sha256(_STYLE.encode()).digest()).decode()
_POLICY = f"default-src 'none'; img-src 'self' file:; style-src 'sha256-{_HASH}'"
"""Whatever text a job contains, the page loads only its own pictures."""
_MOST_ROWS, _MOST_TEXT = 200, 300


def page(
    job: Mapping[str, Any],
    result: Mapping[str, Any] | None,
    events: Sequence[Mapping[str, Any]],
    artifacts: Sequence[Artifact],
) -> str:
    """HTML of one job: facts, outcome, pictures, outputs, files, inputs, provenance, events."""
    title = f"{escape(str(job['process_id']))}: {escape(str(job['status']))}"
    parts = [
        f"<h1>{title}</h1><p>safestart job <code>{escape(str(job['id']))}</code></p>",
        _facts(job, result),
    ]
    pictures = [item for item in artifacts if item.media_type == "image/png"]
    parts += [_picture(item) for item in pictures]
    if result is not None:
        parts += ["<h2>Outputs</h2>", _outputs(result["outputs"])]
    parts += ["<h2>Files</h2>", _files(result, artifacts)]
    parts += ["<h2>Inputs</h2>", _table(job["inputs"])]
    if result is not None:
        parts += ["<h2>Provenance</h2>", _table(result.get("provenance", {}))]
    parts += ["<h2>Events</h2>", _value(list(events))]
    head = (
        f'<meta charset="utf-8"><meta http-equiv="Content-Security-Policy" content="{_POLICY}">'
        f'<meta name="viewport" content="width=device-width"><title>{title}</title><style>{_STYLE}</style>'
    )
    return f'<!doctype html><html lang="en"><head>{head}</head><body>{"".join(parts)}</body></html>\n'


def _facts(job: Mapping[str, Any], result: Mapping[str, Any] | None) -> str:
    problem = job.get("problem")
    labels = {"name": job.get("name"), "tags": ", ".join(job.get("tags", ())), "note": job.get("note")}
    facts = {
        **{name: text for name, text in labels.items() if text},
        "submitted": job.get("created_at"),
        "started": job.get("started_at"),
        "ended": job.get("finished_at"),
        "attempts": job.get("attempts"),
        **({} if not problem else {"why it failed": problem.get("detail") or problem}),
        **({} if result is None else {"content, SHA-256": digest(result)}),
    }
    return _table(facts) + (
        "<p>To check this bundle: <code>safestart import FILE --seal SEAL</code>. "
        "To compute it again and compare: <code>safestart replay FILE</code>.</p>"
    )


def _picture(item: Artifact) -> str:
    name = escape(item.name, quote=True)
    return f'<figure><img src="artifacts/{name}" alt="{name}"><figcaption>{name}</figcaption></figure>'


def _outputs(outputs: Mapping[str, Any]) -> str:
    """Show lists of objects as tables one below the other, at full width, and everything else as one table."""
    tables = {name: value for name, value in outputs.items() if _is_rows(value)}
    rest = {name: value for name, value in outputs.items() if name not in tables}
    return _table(rest) + "".join(
        f"<h3>{escape(str(name))}</h3>{_rows(rows)}" for name, rows in tables.items()
    )


def _is_rows(value: Any) -> bool:
    return isinstance(value, list) and bool(value) and all(isinstance(item, Mapping) for item in value)


def _files(result: Mapping[str, Any] | None, artifacts: Sequence[Artifact]) -> str:
    documents = [*([] if result is None else ["result.json"]), "job.json", "events.json", "manifest.json"]
    links = [f'<li><a href="{name}">{name}</a></li>' for name in documents]
    for item in artifacts:
        name = escape(item.name, quote=True)
        links.append(f'<li><a href="artifacts/{name}">{name}</a> ({len(item.data)} bytes)</li>')
    return f"<ul>{''.join(links)}</ul>"


def _value(value: Any) -> str:
    if isinstance(value, Mapping):
        return _table(value)
    if _is_rows(value):
        return _rows(value)
    if isinstance(value, list) and any(isinstance(item, str) and " " in item for item in value):
        return f"<ul>{''.join(f'<li>{_scalar(item)}</li>' for item in value[:_MOST_ROWS])}</ul>"
    return _scalar(value)


def _table(mapping: Mapping[str, Any]) -> str:
    rows = "".join(
        f"<tr><th>{escape(str(name))}</th><td>{_value(value)}</td></tr>" for name, value in mapping.items()
    )
    return f'<div class="wide"><table>{rows}</table></div>' if rows else "–"


def _rows(rows: Sequence[Mapping[str, Any]]) -> str:
    shown = rows[:_MOST_ROWS]
    names = list(dict.fromkeys(name for row in shown for name in row))
    # Texts come first, as they say what a row is about; large values are folded and come last.
    names.sort(
        key=lambda name: min((_weight(row[name]) for row in shown if row.get(name) is not None), default=3)
    )
    head = "".join(f"<th>{escape(str(name))}</th>" for name in names)
    body = "".join("<tr>" + "".join(_cell(row.get(name)) for name in names) + "</tr>" for row in shown)
    more = f"<p>{len(rows) - _MOST_ROWS} more in the JSON.</p>" if len(rows) > _MOST_ROWS else ""
    return f'<div class="wide"><table><tr>{head}</tr>{body}</table></div>{more}'


def _weight(value: Any) -> int:
    if isinstance(value, str):
        return 0
    return 2 if isinstance(value, Mapping | list) else 1


def _cell(value: Any) -> str:
    if isinstance(value, Mapping) and value:
        return f"<td><details><summary>{len(value)} values</summary>{_table(value)}</details></td>"
    if isinstance(value, int | float) and not isinstance(value, bool):
        return f'<td class="number">{_scalar(value)}</td>'
    return f"<td>{_value(value)}</td>"


def _scalar(value: Any) -> str:
    if value is None or value == "":
        return "–"
    text = escape(_text(value))
    if len(text) > _MOST_TEXT:
        text = escape(_text(value)[:_MOST_TEXT]) + " … (the rest is in the JSON)"
    return text


def _text(value: Any) -> str:
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, list):
        return ", ".join(f"[{_text(item)}]" if isinstance(item, list) else _text(item) for item in value)
    return f"{value:.6g}" if isinstance(value, float) else str(value)
