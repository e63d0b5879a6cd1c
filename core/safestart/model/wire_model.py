"""The base of every model that crosses the wire."""

from __future__ import annotations

from typing import Any

from pydantic import BaseModel, ConfigDict, GetCoreSchemaHandler
from pydantic_core import CoreSchema


def _stop_early(schema: Any) -> None:
    if isinstance(schema, list | tuple):
        for part in schema:
            _stop_early(part)
    elif isinstance(schema, dict):
        if schema.get("type") == "list":
            schema["fail_fast"] = True
        for name, part in schema.items():
            if name != "metadata":
                _stop_early(part)


class WireModel(BaseModel):
    """Base of every model that crosses the wire: it refuses unknown fields, NaN and infinity.

    Its validator is built with its first use, as no process uses them all.
    """

    model_config = ConfigDict(
        extra="forbid", frozen=True, allow_inf_nan=False, strict=False, defer_build=True
    )

    @classmethod
    def __get_pydantic_core_schema__(cls, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        """The usual schema, with lists that stop at their first wrong item.

        A report for each of 100 000 wrong items would cost more than all that they ask for.
        """
        schema = handler(source)
        _stop_early(schema)
        return schema
