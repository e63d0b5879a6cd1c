"""Rows of a result, added in the transaction that ends its job."""

from __future__ import annotations

from typing import Any

from sqlalchemy import insert
from sqlalchemy.orm import Session

from safestart.records.artifact import Artifact
from safestart.records.comparable import digest
from safestart.store.cache import shelve
from safestart.store.dialect import after
from safestart.store.models import ArtifactRow, ResultRow, table

_RESULT = insert(table(ResultRow)).values(created_at=after()).inline()
_ARTIFACT = insert(table(ArtifactRow)).inline()


def add_result(
    session: Session, job_id: str, document: dict[str, Any], artifacts: tuple[Artifact, ...]
) -> None:
    """Insert the document with its hash and the artifacts with sizes and hashes; cache those with a content key."""
    result = {
        "job_id": job_id,
        "schema_version": document.get("schema_version", 1),
        "document": document,
        "sha256": digest(document),
    }
    session.execute(_RESULT, result)
    for item in artifacts:
        artifact = {
            "job_id": job_id,
            "name": item.name,
            "media_type": item.media_type,
            "size": len(item.data),
            "sha256": item.sha256,
            "data": item.data,
        }
        session.execute(_ARTIFACT, artifact)
        if item.key is not None:
            shelve(session, item.key, item.data)
