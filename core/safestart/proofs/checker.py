"""Any proof document checked: single starts (``proof.py``) and families (``families/proof.py``)."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from safestart.proofs import family as for_all
from safestart.proofs import family_statement
from safestart.proofs import single as proof
from safestart.proofs.single import Verified


def check(document: Any) -> Verified:
    """Check a proof of either schema; raise ``ProofRejected`` when it is malformed or an inequality fails."""
    if isinstance(document, Mapping) and document.get("schema") == family_statement.SCHEMA:
        return for_all.check(document)
    return proof.check(document)
