"""The paper's conditions in words: the binding constraint, the violated faces, and one sentence."""

from __future__ import annotations

from collections.abc import Sequence


def binding_of(
    faces: Sequence[str], slack: Sequence[float], face_margin: Sequence[float], range_margin: float
) -> tuple[str, list[str]]:
    """Binding constraint (a face or ``range``) of one start, and the faces that it violates.

    ``slack`` and ``face_margin`` go face by face; margins in metres. Outside the corridor a violated face binds.
    """
    tightest = min(face_margin)
    binding = "range" if range_margin <= tightest else faces[face_margin.index(tightest)]
    violated = [face for face, value in zip(faces, slack, strict=True) if value < 0.0]
    return (violated[0] if violated and binding not in violated else binding), violated


def sentence(binding: str, violated: Sequence[str], range_margin: float, margin: float) -> str:
    """Why the paper's conditions hold or not at a start of this smallest margin (m)."""
    if violated:
        return f"outside the corridor: violates {', '.join(violated)}"
    if margin > 0.0:
        return f"the paper's conditions hold with {margin:.2f} m to spare at {binding}"
    if binding == "range":
        return f"{-range_margin:.2f} m beyond the range within which the rotation can be matched"
    return (
        f"the rotation consumes the slack of {binding} before full thrust arrests it ({-margin:.2f} m short)"
    )
