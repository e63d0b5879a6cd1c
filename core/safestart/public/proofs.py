"""`verify`: check a proof document in ball arithmetic, by code that shares nothing with the prover."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from safestart.errors import invalid
from safestart.proofs.single import Verified
from safestart.runtime.files.bounded import bytes_within
from safestart.runtime.plain_json import loads

_MOST_BYTES = 16 * 1024 * 1024


def verify(proof: Mapping[str, Any] | str | os.PathLike[str]) -> Verified:
    """Check a proof, a document or the path of its file.

    The result states all that is proved (``verdict``, ``margin_m`` in metres, ``statement`` in lines). Raises
    ``ProofRejected`` with the reason if an inequality fails or the document is malformed, ``InvalidInput`` if the file
    is unreadable.
    """
    from safestart.proofs.checker import check

    return check(proof if isinstance(proof, Mapping) else _read(Path(proof)))


def _read(path: Path) -> Any:
    try:
        return loads(bytes_within("proof", path, _MOST_BYTES))
    except OSError as error:
        raise invalid("proof", "a readable file", f"{path} ({error.strerror})") from None
    except (ValueError, RecursionError) as error:
        raise invalid("proof", "JSON with every name once in an object", f"{path} ({error})") from None
