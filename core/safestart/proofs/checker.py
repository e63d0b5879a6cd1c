"""Check any proof document: single starts (``single.py``), families (``family.py``), disturbances
(``disturbed.py``), plans with burns that fail (``abort/``), starts in space (``space/``)."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from safestart.proofs import disturbed, disturbed_statement, family_statement
from safestart.proofs import family as for_all
from safestart.proofs import single as proof
from safestart.proofs.abort import check as abort
from safestart.proofs.abort.statement import SCHEMA as ABORT
from safestart.proofs.abort.statement import WIDER as WIDER_ABORT
from safestart.proofs.abort.wording import lines
from safestart.proofs.single import Verified
from safestart.proofs.space import check as space
from safestart.proofs.space import statement as space_statement
from safestart.proofs.strict import ProofRejected


def check(document: Any) -> Verified:
    """Check a proof of any schema; raise ``ProofRejected`` when it is malformed or an inequality fails.

    Numbers may be so large or small that nothing finite can be computed from them: that is no proof either.
    """
    try:
        return _check(document)
    except (ArithmeticError, ValueError) as error:
        raise ProofRejected(f"required numbers from which bounds can be computed ({error})") from None


def _check(document: Any) -> Verified:
    schema = document.get("schema") if isinstance(document, Mapping) else None
    if schema == family_statement.SCHEMA:
        return for_all.check(document)
    if schema == disturbed_statement.SCHEMA:
        return disturbed.check(document)
    if schema == space_statement.SCHEMA:
        return space.check(document)
    if schema in (ABORT, WIDER_ABORT):
        asked, cells = abort.check(document)
        return Verified("PROVED", float(document["least_distance_m"]), cells, lines(asked))
    return proof.check(document)
