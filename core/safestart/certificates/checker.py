"""Any proof document checked: single starts (``proof.py``) and families (``families/proof.py``)."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from safestart.certificates import proof
from safestart.certificates.families import proof as for_all
from safestart.certificates.families import statement as family_statement
from safestart.certificates.proof import Verified


def check(document: Any) -> Verified:
    """Check a proof of either schema; raise ``ProofRejected`` when it is malformed or an inequality fails."""
    if isinstance(document, Mapping) and document.get("schema") == family_statement.SCHEMA:
        return for_all.check(document)
    return proof.check(document)
