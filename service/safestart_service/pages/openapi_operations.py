"""The API description, prepared for its page."""

from __future__ import annotations

from typing import Any


def api_operations(description: dict[str, Any]) -> dict[str, list[dict[str, Any]]]:
    """Operations of an OpenAPI document by tag, with the facts that a reader needs."""
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
