"""JSON schemas that mean the same in JSON Schema 2020-12 and in OpenAPI 3.0.

OGC API - Processes 1.0 describes inputs by the schema object of OpenAPI 3.0, where exclusive bounds are truth
values, null is not a type and tuples do not exist. Most other tools read JSON Schema. The schemas here are valid in
both.
"""

from __future__ import annotations

import math
from typing import Any

_DROPPED = ("$defs", "examples", "propertyNames", "discriminator", "$schema")


def common(schema: Any) -> Any:
    """Rewrite a schema without references. The result may allow more than the original, never less."""
    if isinstance(schema, list):
        return [common(item) for item in schema]
    if not isinstance(schema, dict):
        return schema
    found: dict[str, Any] = {}
    for key, value in schema.items():
        if key == "properties":
            found[key] = {name: common(item) for name, item in value.items()}
        elif key in ("default", "enum", "example", "required"):
            found[key] = value
        elif key not in _DROPPED:
            found[key] = common(value)
    _bounds(found)
    if "const" in found:
        found["enum"] = [found.pop("const")]
    if found.get("type") == "null":
        del found["type"]
        found["enum"] = [None]
    if "prefixItems" in found:
        items = found.pop("prefixItems")
        found["items"] = items[0] if all(item == items[0] for item in items) else {"anyOf": items}
    if schema.get("examples"):
        found["example"] = schema["examples"][0]
    return found


def _bounds(found: dict[str, Any]) -> None:
    """Replace an exclusive bound by the next float64 number, or for integers by the next integer."""
    whole = found.get("type") == "integer"
    for exclusive, inclusive, side in (
        ("exclusiveMinimum", "minimum", 1),
        ("exclusiveMaximum", "maximum", -1),
    ):
        if exclusive not in found:
            continue
        bound = found.pop(exclusive)
        found[inclusive] = math.floor(bound) + side if whole else math.nextafter(bound, side * math.inf)
