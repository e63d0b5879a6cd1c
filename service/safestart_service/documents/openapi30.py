"""The API description in OpenAPI 3.0, which OGC API - Processes 1.0 names and which many client generators need.

OpenAPI 3.1 has JSON Schema 2020-12; 3.0 has an older dialect without null as a type, constants, tuples and several
examples, and with exclusive bounds as truth values.
"""

from __future__ import annotations

from typing import Any

VERSION = "3.0.3"
_DATA = ("default", "enum", "example", "value", "required")
"""Members that hold data, not schemas."""
_DROPPED = ("propertyNames", "$schema")


def older(document: dict[str, Any]) -> dict[str, Any]:
    """A description in OpenAPI 3.1, of the parts that ours uses, as one in 3.0."""
    schemas = document["components"]["schemas"]
    types = {f"#/components/schemas/{name}": schema["type"] for name, schema in schemas.items()}
    found: dict[str, Any] = _outside(document, types)
    return found | {"openapi": VERSION}


def _outside(node: Any, types: dict[str, str]) -> Any:
    """A node that is not a schema: here ``examples`` is a table by name and stays."""
    if isinstance(node, list):
        return [_outside(item, types) for item in node]
    if not isinstance(node, dict):
        return node
    found = {}
    for name, value in node.items():
        if name == "schema":
            found[name] = _schema(value, types)
        elif name == "schemas":
            found[name] = {key: _schema(item, types) for key, item in value.items()}
        else:
            found[name] = value if name in _DATA else _outside(value, types)
    return found


def _schema(node: Any, types: dict[str, str]) -> Any:
    if isinstance(node, list):
        return [_schema(item, types) for item in node]
    if not isinstance(node, dict):
        return node
    found: dict[str, Any] = {}
    for name, value in node.items():
        if name == "properties":
            found[name] = {key: _schema(item, types) for key, item in value.items()}
        elif name not in _DROPPED:
            found[name] = value if name in (*_DATA, "examples") else _schema(value, types)
    _adapt(found)
    _without_null(found, types)
    if "$ref" in found and len(found) > 1:  # beside a reference 3.0 reads nothing
        found["allOf"] = [{"$ref": found.pop("$ref")}]
    return found


def _adapt(found: dict[str, Any]) -> None:
    if "const" in found:
        found["enum"] = [found.pop("const")]
    if "examples" in found:
        found["example"] = found.pop("examples")[0]
    for bound, side in (("exclusiveMinimum", "minimum"), ("exclusiveMaximum", "maximum")):
        if bound in found:
            found[side], found[bound] = found[bound], True
    if "prefixItems" in found:
        items = found.pop("prefixItems")
        found["items"] = items[0] if all(item == items[0] for item in items) else {"anyOf": items}
    if found.get("type") == "array":
        found.setdefault("items", {})


def _without_null(found: dict[str, Any], types: dict[str, str]) -> None:
    """``nullable`` for null among the variants or as the type; 3.0 wants the type beside it."""
    if found.get("type") == "null":
        found |= {"type": "string", "nullable": True, "enum": [None]}
        return
    variants = found.get("anyOf", [])
    rest = [item for item in variants if item.get("enum") != [None]]
    kinds = _kinds(rest, types)
    if len(rest) == len(variants) or len(kinds) != 1:  # without null, or the variant for null stays
        return
    del found["anyOf"]
    found |= {"type": kinds.pop(), "nullable": True}
    if found.get("default", "") is None and (len(rest) > 1 or "type" not in rest[0]):
        del found["default"]  # no value of the variants
    if len(rest) > 1:
        found["anyOf"] = rest
    elif "$ref" in rest[0]:
        found["allOf"] = rest
    else:
        found |= {name: value for name, value in rest[0].items() if name not in found}
        if "enum" in found:
            found["enum"] = [*found["enum"], None]


def _kinds(variants: list[dict[str, Any]], types: dict[str, str]) -> set[str]:
    found: set[str] = set()
    for item in variants:
        if "type" in item or "$ref" in item:
            found.add(item.get("type") or types[item["$ref"]])
        else:
            found |= _kinds([*item.get("anyOf", ()), *item.get("oneOf", ()), *item.get("allOf", ())], types)
    return found
