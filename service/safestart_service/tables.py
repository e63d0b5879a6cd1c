"""Documents taken apart for pages: outputs into scalars and tables, the API description into operations."""

from __future__ import annotations

from typing import Any

MAX_ROWS = 500


def split_outputs(outputs: dict[str, Any]) -> dict[str, Any]:
    """Scalars, tables (lists of objects) and names of arrays that only the JSON document shows."""
    scalars: dict[str, Any] = {}
    tables: dict[str, dict[str, Any]] = {}
    arrays: list[str] = []
    for name, value in outputs.items():
        if not isinstance(value, list | dict):
            scalars[name] = value
        elif isinstance(value, list) and value and all(isinstance(row, dict) for row in value):
            tables[name] = _table(value)
        elif isinstance(value, list) and len(value) <= 12 and all(isinstance(item, str) for item in value):
            scalars[name] = value
        else:
            arrays.append(name)
    return {"scalars": scalars, "tables": tables, "arrays": arrays}


def _table(rows: list[dict[str, Any]]) -> dict[str, Any]:
    """Columns in order of appearance; objects contribute their scalars as ``name.member``; empty columns go."""
    flat = [_flat(row) for row in rows[:MAX_ROWS]]
    columns = list(dict.fromkeys(name for row in flat for name in row))
    columns = [name for name in columns if any(row.get(name) not in (None, "") for row in flat)]
    return {
        "columns": columns,
        "rows": [[row.get(name) for name in columns] for row in flat],
        "left_out": len(rows) - len(flat),
    }


def _flat(row: dict[str, Any]) -> dict[str, Any]:
    found: dict[str, Any] = {}
    for name, value in row.items():
        if name == "detail":  # an engine's own diagnostics: for the JSON document
            continue
        if isinstance(value, dict):
            found.update(
                {f"{name}.{key}": item for key, item in value.items() if not isinstance(item, list | dict)}
            )
        elif not isinstance(value, list):
            found[name] = value
    return found


def api_operations(description: dict[str, Any]) -> dict[str, list[dict[str, Any]]]:
    """Operations of an OpenAPI document by tag, with what a reader needs of each."""
    groups: dict[str, list[dict[str, Any]]] = {}
    for path, methods in description["paths"].items():
        for method, operation in methods.items():
            body = operation.get("requestBody", {}).get("content", {}).get("application/json", {})
            groups.setdefault(operation.get("tags", ["other"])[0], []).append(
                {
                    "method": method.upper(),
                    "path": path,
                    "summary": operation.get("summary", ""),
                    "text": operation.get("description", ""),
                    "parameters": [_parameter(item) for item in operation.get("parameters", ())],
                    "examples": {name: item["value"] for name, item in body.get("examples", {}).items()},
                    "responses": {
                        status: response["description"] for status, response in operation["responses"].items()
                    },
                }
            )
    return groups


def _parameter(item: dict[str, Any]) -> dict[str, Any]:
    schema = item["schema"]
    variants = schema.get("anyOf", [schema])
    first = variants[0]
    bounds = []
    for key, sign in (("exclusiveMinimum", ">"), ("minimum", "≥"), ("maximum", "≤")):
        if key in first:
            bounds.append(f"{sign} {first[key]:g}")
    return {
        "name": item["name"],
        "place": item["in"],
        "required": item.get("required", False),
        "kind": first.get("type") or first.get("$ref", "").rpartition("/")[2],
        "bounds": ", ".join(bounds),
        "default": schema.get("default"),
        "text": item.get("description") or schema.get("description", ""),
    }
