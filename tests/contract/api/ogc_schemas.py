"""What OGC API - Processes 1.0 (OGC 18-062r2) requires of its documents, as JSON schemas in our own words."""

from __future__ import annotations

from typing import Any

STATUSES = ["accepted", "running", "successful", "failed", "dismissed"]
_TIME = {"type": "string", "format": "date-time"}
_WORDS = ("title", "description")


def _object(required: list[str], **properties: Any) -> dict[str, Any]:
    return {"type": "object", "required": required, "properties": properties}


LINK = _object(
    ["href"], **{name: {"type": "string"} for name in ("href", "rel", "type", "hreflang", "title")}
)
LINKS = {"type": "array", "items": LINK}
LANDING = _object(["links"], links=LINKS, **{name: {"type": "string"} for name in _WORDS})
CONFORMANCE = _object(["conformsTo"], conformsTo={"type": "array", "items": {"type": "string"}})
EXCEPTION = _object(
    ["type"],
    **{name: {"type": "string"} for name in ("type", "title", "detail", "instance")},
    status={"type": "integer"},
)
STATUS_INFO = _object(
    ["jobID", "status", "type"],
    jobID={"type": "string"},
    processID={"type": "string"},
    type={"enum": ["process"]},
    status={"enum": STATUSES},
    message={"type": "string"},
    created=_TIME,
    started=_TIME,
    finished=_TIME,
    updated=_TIME,
    progress={"type": "integer", "minimum": 0, "maximum": 100},
    links=LINKS,
)
JOB_LIST = _object(["jobs", "links"], jobs={"type": "array", "items": STATUS_INFO}, links=LINKS)
SUMMARY = _object(
    ["id", "version"],
    id={"type": "string"},
    version={"type": "string"},
    keywords={"type": "array", "items": {"type": "string"}},
    jobControlOptions={"type": "array", "items": {"enum": ["sync-execute", "async-execute", "dismiss"]}},
    outputTransmission={"type": "array", "items": {"enum": ["value", "reference"]}},
    links=LINKS,
    **{name: {"type": "string"} for name in _WORDS},
)
PROCESS_LIST = _object(["processes", "links"], processes={"type": "array", "items": SUMMARY}, links=LINKS)

_SCHEMA = {"$ref": "#/$defs/schema"}
_SCHEMAS = {"type": "array", "items": _SCHEMA}
_COUNT = {"type": "integer", "minimum": 0}
_TRUTH = {"type": "boolean"}
SCHEMA_OBJECT = {
    "type": "object",
    "additionalProperties": False,
    "properties": {
        **{
            name: {"type": "string"}
            for name in ("title", "description", "format", "pattern", "contentMediaType")
        },
        **{name: {"type": "number"} for name in ("minimum", "maximum", "multipleOf")},
        **{
            name: _TRUTH
            for name in ("exclusiveMinimum", "exclusiveMaximum", "uniqueItems", "nullable", "deprecated")
        },
        **{
            name: _COUNT
            for name in ("minLength", "maxLength", "minItems", "maxItems", "minProperties", "maxProperties")
        },
        **{name: _SCHEMAS for name in ("allOf", "anyOf", "oneOf")},
        "type": {"enum": ["array", "boolean", "integer", "number", "object", "string"]},
        "required": {"type": "array", "items": {"type": "string"}, "minItems": 1, "uniqueItems": True},
        "enum": {"type": "array", "minItems": 1},
        "not": _SCHEMA,
        "items": _SCHEMA,
        "properties": {"type": "object", "additionalProperties": _SCHEMA},
        "additionalProperties": {"anyOf": [_SCHEMA, _TRUTH]},
        "default": {},
        "example": {},
    },
}
"""The schema object of OpenAPI 3.0, by which inputs and outputs are described."""
_DESCRIBED = {**_object(["schema"], schema=_SCHEMA, **{name: {"type": "string"} for name in _WORDS})}
_INPUT = {
    "allOf": [
        _DESCRIBED,
        _object(
            [],
            minOccurs={"type": "integer"},
            maxOccurs={"anyOf": [{"type": "integer"}, {"const": "unbounded"}]},
        ),
    ]
}
PROCESS = {
    "$defs": {"schema": SCHEMA_OBJECT},
    "allOf": [
        SUMMARY,
        _object(
            ["inputs", "outputs"],
            inputs={"type": "object", "additionalProperties": _INPUT},
            outputs={"type": "object", "additionalProperties": _DESCRIBED},
        ),
    ],
}
_VALUE = {"type": ["string", "number", "boolean", "array"]}
RESULTS = {
    "type": "object",
    "additionalProperties": {
        "anyOf": [
            _VALUE,
            _object(["value"], value={"type": ["string", "number", "boolean", "array", "object"]}),
            LINK,
        ]
    },
}
