"""Read lists by status from an index; give counting columns 64 bits, for more than 2**31 rows on PostgreSQL."""

import sqlalchemy as sa
from alembic import op

revision = "0006"
down_revision = "0005"
branch_labels = None
depends_on = None

COUNTERS = (("jobs", "seq"), ("events", "id"), ("audit", "id"), ("cache", "seq"))


def upgrade() -> None:
    op.create_index("ix_jobs_status_seq", "jobs", ["status", "seq"])
    _counters(sa.BigInteger(), "bigint")


def downgrade() -> None:
    op.drop_index("ix_jobs_status_seq", "jobs")
    _counters(sa.Integer(), "integer")


def _counters(kind: sa.types.TypeEngine[int], name: str) -> None:
    if op.get_bind().dialect.name != "postgresql":  # SQLite's integers have 64 bits
        return
    for table, column in COUNTERS:
        op.alter_column(table, column, type_=kind)
        op.execute(f"ALTER SEQUENCE {table}_{column}_seq AS {name}")
    op.alter_column("jobs", "turn", type_=kind)
