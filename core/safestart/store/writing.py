"""Rows of a result, added in the transaction that ends its job."""

from __future__ import annotations

from typing import Any

from sqlalchemy import insert
from sqlalchemy.orm import Session

from safestart.artifact import Artifact
from safestart.comparable import digest
from safestart.store.cache import shelve
from safestart.store.dialect import after
from safestart.store.models import ArtifactRow, ResultRow


def add_result(
    session: Session, job_id: str, document: dict[str, Any], artifacts: tuple[Artifact, ...]
) -> None:
    """Insert the document with its hash, each artifact with size and hash; what has a content key is cached, too."""
    session.execute(
        insert(ResultRow).values(
            job_id=job_id,
            schema_version=document.get("schema_version", 1),
            document=document,
            sha256=digest(document),
            created_at=after(),
        )
    )
    for item in artifacts:
        session.execute(
            insert(ArtifactRow).values(
                job_id=job_id,
                name=item.name,
                media_type=item.media_type,
                size=len(item.data),
                sha256=item.sha256,
                data=item.data,
            )
        )
        if item.key is not None:
            shelve(session, item.key, item.data)
