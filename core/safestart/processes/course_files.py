"""A flight's files of the field as artifacts."""

from __future__ import annotations

from safestart.interchange.flights import FlightCourses
from safestart.processes.base import Artifact

_MEDIA_TYPES = {"czml": "application/json"}


def course_files(courses: FlightCourses) -> tuple[Artifact, ...]:
    """OEM, AEM, OPM, OCM and CZML."""
    return tuple(
        Artifact(name, _MEDIA_TYPES.get(name.rpartition(".")[2], "text/plain"), data)
        for name, data in courses.files().items()
    )
