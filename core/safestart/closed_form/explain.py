"""A verdict in words: what binds, which faces the start is outside of, and one sentence."""

from __future__ import annotations

from collections.abc import Sequence


def explain(
    faces: Sequence[str],
    slack: Sequence[float],
    face_margin: Sequence[float],
    range_margin: float,
    margin: float,
) -> tuple[str, list[str], str]:
    """Binding constraint (a face or ``range``), violated faces and the sentence for one certified start.

    ``slack`` and ``face_margin`` go face by face; margins in metres.
    """
    tight = min(range(len(faces)), key=face_margin.__getitem__)
    name = "range" if range_margin <= face_margin[tight] else faces[tight]
    violated = [face for face, value in zip(faces, slack, strict=True) if value < 0.0]
    if violated:
        binding = name if name in violated else violated[0]
        return binding, violated, f"outside the corridor: violates {', '.join(violated)}"
    if margin > 0.0:
        sentence = f"certified with {margin:.2f} m to spare at {name}"
    elif name == "range":
        sentence = f"{-range_margin:.2f} m beyond the range within which the rotation can be matched"
    else:
        sentence = (
            f"the rotation consumes the slack of {name} before full thrust arrests it ({-margin:.2f} m short)"
        )
    return name, violated, sentence
