"""Name, tags and note of a job, the outcome of its result, and what its list is searched and sorted by."""

import sqlalchemy as sa
from alembic import op

revision = "0007"
down_revision = "0006"
branch_labels = None
depends_on = None

INDICES = (("process_id", "seq"), ("verdict", "seq"), ("search", "seq"))
COLUMNS = ("outcome", "verdict", "search", "note", "tags", "name")


def upgrade() -> None:
    op.add_column("jobs", sa.Column("name", sa.String(100), nullable=False, server_default=""))
    op.add_column("jobs", sa.Column("tags", sa.JSON, nullable=False, server_default="[]"))
    op.add_column("jobs", sa.Column("note", sa.Text, nullable=False, server_default=""))
    op.add_column("jobs", sa.Column("search", sa.Text, nullable=False, server_default=""))
    op.add_column("jobs", sa.Column("verdict", sa.String(64)))
    op.add_column("jobs", sa.Column("outcome", sa.JSON))
    # The outcome of earlier results stays unknown: this layer knows no process that could say it.
    parts = {"line": "\n"}
    text = sa.text("UPDATE jobs SET search = :line || lower(id) || :line || lower(process_id) || :line")
    op.get_bind().execute(text, parts)
    for first, second in INDICES:
        op.create_index(f"ix_jobs_{first.removesuffix('_id')}_seq", "jobs", [first, second])


def downgrade() -> None:
    for first, _ in INDICES:
        op.drop_index(f"ix_jobs_{first.removesuffix('_id')}_seq", "jobs")
    for column in COLUMNS:
        op.drop_column("jobs", column)
