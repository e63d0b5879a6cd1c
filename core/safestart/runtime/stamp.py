"""A digest of source files, so that a cached kernel is recompiled when a kernel it calls has changed."""

from __future__ import annotations

import hashlib
from pathlib import Path
from types import ModuleType


def source_stamp(*modules: ModuleType) -> int:
    """Integer digest of the source text of ``modules``.

    Numba's on-disk cache looks at the file of the cached function only: after a change in a file it calls, the
    old machine code would still be loaded. A cached kernel therefore closes over this number, which is part
    of Numba's key.
    """
    digest = hashlib.sha256()
    for module in modules:
        digest.update(Path(str(module.__file__)).read_bytes())
    return int.from_bytes(digest.digest()[:6], "big")
