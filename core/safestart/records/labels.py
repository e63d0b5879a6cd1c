"""What people write on a job: a name, tags, a note. They change nothing that is computed."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Annotated, Any

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, StringConstraints, ValidationError

from safestart.model.plain_text import UNPRINTED
from safestart.model.validation import validation_error

MOST_NAME, MOST_TAGS, MOST_TAG, MOST_NOTE = 100, 10, 40, 2000
"""Letters of a name, tags of a job, letters of a tag and of a note."""
_LINE, _TAG, _LINES = rf"^[^\t\n{UNPRINTED}]*$", rf"^[^,\t\n{UNPRINTED}]+$", rf"^[^{UNPRINTED}]*$"


def _once(tags: list[str]) -> list[str]:
    return list(dict.fromkeys(tags))


Name = Annotated[str, StringConstraints(strip_whitespace=True, max_length=MOST_NAME, pattern=_LINE)]
Tag = Annotated[
    str, StringConstraints(strip_whitespace=True, min_length=1, max_length=MOST_TAG, pattern=_TAG)
]
Tags = Annotated[list[Tag], Field(max_length=MOST_TAGS), AfterValidator(_once)]
Note = Annotated[str, StringConstraints(strip_whitespace=True, max_length=MOST_NOTE, pattern=_LINES)]
NAME_TEXT = "What people call the job; one line."
TAGS_TEXT = "Words to find jobs by; without commas, each once."
NOTE_TEXT = "Whatever should be remembered with the job; may have several lines."


class Labels(BaseModel):
    """Name, tags and note of a job; empty where nobody gave any."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    name: Name = ""
    tags: Tags = []
    note: Note = ""


NONE = Labels()
"""No labels."""


def labels_of(**given: Any) -> dict[str, Any]:
    """The given ones of ``name``, ``tags`` and ``note`` (None: not given), checked; raises ``InvalidInput``."""
    told = {name: value for name, value in given.items() if value is not None}
    if isinstance(told.get("tags"), Iterable) and not isinstance(told["tags"], str):
        told["tags"] = list(told["tags"])
    try:
        return Labels.model_validate(told).model_dump(include=set(told))
    except ValidationError as error:
        raise validation_error(error) from None
