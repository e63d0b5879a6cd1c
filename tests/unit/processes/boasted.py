"""A prover that claims a metre more than it has, for tests of who believes it."""

from typing import Any

from safestart.missed_burn.document import document_of
from safestart.missed_burn.prove import Proof
from safestart.proofs.statement import digest_of


def boasted(proof: Proof) -> dict[str, Any]:
    """The proof's document with a metre more, sealed again."""
    document: dict[str, Any] = document_of(proof)
    document["least_distance_m"] += 1.0
    document["digest"] = digest_of({k: v for k, v in document.items() if k != "digest"})
    return document
