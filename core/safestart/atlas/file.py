"""An atlas as bytes (NPZ) and back, bit for bit, and its content key in the cache."""

from __future__ import annotations

import io
import json
import zipfile
import zlib
from dataclasses import asdict
from hashlib import sha256
from typing import Any

import numpy as np

from safestart.atlas.atlas import Atlas
from safestart.atlas.evidence import require_borne_out
from safestart.atlas.extent import Ceiling, Witness
from safestart.errors import InvalidInput, invalid
from safestart.exact.question import Question
from safestart.model.scenario import Chaser, CorridorShape, Floats, Scenario, Target
from safestart.records.provenance import source

FORMAT = "safestart-atlas/1"
_REQUIRED = f"an atlas file ({FORMAT})"
_ARRAYS = (
    *("head", "start", "thrust", "margin", "angles", "corners"),
    *("slope", "level", "rows", "times", "faces", "weights"),
)


def key_of(question: Question, y_max: float, tolerance: float) -> str:
    """Content key: SHA-256 over the format, our source, the question, the cut (m) and the requested relative gap.

    The key includes the source, because answers must come from the code that their provenance names.
    """
    stated = {
        "format": FORMAT,
        "source": source(),
        "question": asdict(question),
        "y_max": float(y_max),
        "tolerance": float(tolerance),
    }
    return sha256(json.dumps(stated, sort_keys=True, separators=(",", ":")).encode()).hexdigest()


def pack(atlas: Atlas) -> bytes:
    """The atlas with all its witnesses and multipliers; equal atlases give equal bytes."""
    witnesses = (atlas.deepest, atlas.centre, *atlas.rim)
    rows = [len(c.times) for c in atlas.ceilings]
    buffer = io.BytesIO()
    np.savez_compressed(
        buffer,
        allow_pickle=False,
        head=np.array(_head(atlas)),
        start=np.array([w.start for w in witnesses]),
        thrust=np.array([w.thrust for w in witnesses]),
        margin=np.array([w.margin for w in witnesses]),
        angles=atlas.angles,
        corners=atlas.corners,
        slope=atlas.slopes,
        level=atlas.levels,
        rows=np.array(rows, dtype=np.int64),
        times=_joined([c.times for c in atlas.ceilings]),
        faces=_joined([c.faces for c in atlas.ceilings]).astype(np.int64),
        weights=_joined([c.weights for c in atlas.ceilings]),
    )
    return buffer.getvalue()


def unpack(data: bytes) -> Atlas:
    """The atlas that :func:`pack` wrote; raises ``InvalidInput`` for anything else.

    :mod:`~safestart.atlas.evidence` computes the file's claims again and refuses a margin, a ceiling or an area that
    its thrusts and multipliers do not prove.
    """
    try:
        with np.load(io.BytesIO(data), allow_pickle=False) as found:
            if sorted(found.files) != sorted(_ARRAYS):
                raise invalid("atlas", f"{_REQUIRED} with the arrays {', '.join(_ARRAYS)}", found.files)
            arrays = dict(found)
        head = json.loads(str(arrays["head"]))
        if head["format"] != FORMAT:
            raise invalid("atlas", _REQUIRED, head["format"])
        atlas = _assembled(head, arrays)
        if _head(atlas) != str(arrays["head"]):
            raise invalid("atlas", f"{_REQUIRED} with a head as it is written", "another")
        require_borne_out(atlas)
        return atlas
    except InvalidInput:
        raise
    except (
        KeyError,
        ValueError,
        TypeError,
        AttributeError,
        IndexError,
        OSError,
        EOFError,
        RecursionError,
        zlib.error,
        zipfile.BadZipFile,
    ) as error:
        raise invalid("atlas", _REQUIRED, f"{type(error).__name__} while reading it") from None


def _head(atlas: Atlas) -> str:
    head = {
        "format": FORMAT,
        "question": asdict(atlas.question),
        "y_max": atlas.y_max,
        "inner_area": atlas.inner_area,
        "outer_area": atlas.outer_area,
        "names": list(atlas.names),
        "message": atlas.message,
    }
    return json.dumps(head, sort_keys=True)


def _assembled(head: dict[str, Any], arrays: dict[str, Any]) -> Atlas:
    stated = dict(head["question"])
    scenario = stated.pop("scenario")
    if stated["goal"] is not None:
        raise invalid("atlas", "a question without a goal", stated["goal"])
    question = Question(
        Scenario(
            Target(**scenario["target"]),
            Chaser(**scenario["chaser"]),
            CorridorShape(**scenario["corridor"]),
        ),
        **stated,
    )
    _require_shapes(arrays, question.steps)
    witnesses = [
        Witness(start, thrust, float(margin))
        for start, thrust, margin in zip(arrays["start"], arrays["thrust"], arrays["margin"], strict=True)
    ]
    ends = np.cumsum(arrays["rows"])[:-1]
    parts = (
        np.split(arrays[name], ends) if len(arrays["rows"]) else [] for name in ("times", "faces", "weights")
    )
    ceilings = tuple(
        Ceiling(slope, float(level), times, faces, weights)
        for slope, level, times, faces, weights in zip(arrays["slope"], arrays["level"], *parts, strict=True)
    )
    return Atlas(
        question,
        head["y_max"],
        witnesses[0],
        witnesses[1],
        tuple(witnesses[2:]),
        arrays["corners"],
        arrays["margin"][2:],
        arrays["angles"],
        ceilings,
        arrays["slope"],
        arrays["level"],
        head["inner_area"],
        head["outer_area"],
        tuple(head["names"]),
        head["message"],
    )


def _require_shapes(arrays: dict[str, Any], steps: int) -> None:
    """Shapes and types of the arrays, and finite numbers in them."""
    count, ceilings, rows = len(arrays["margin"]), len(arrays["level"]), len(arrays["times"])
    shapes = {
        "head": (),
        "start": (count, 2),
        "thrust": (count, steps, 2),
        "margin": (count,),
        "angles": (count - 2,),
        "corners": (count - 2, 2),
        "slope": (ceilings, 2),
        "level": (ceilings,),
        "rows": (ceilings,),
        "times": (rows,),
        "faces": (rows,),
        "weights": (rows,),
    }
    for name, shape in shapes.items():
        array, kind = arrays[name], {"head": "U", "rows": "i", "faces": "i"}.get(name, "f")
        if array.shape != shape or array.dtype.kind != kind or (kind == "f" and not np.isfinite(array).all()):
            raise invalid(f"atlas.{name}", f"finite numbers of shape {shape}", array.shape)
    if (arrays["rows"] < 1).any() or int(arrays["rows"].sum()) != rows:
        raise invalid("atlas.rows", f"numbers of rows with the sum {rows}", arrays["rows"].tolist())


def _joined(parts: list[Floats]) -> Any:
    return np.concatenate(parts) if parts else np.empty(0)
