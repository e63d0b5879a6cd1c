"""Fair queue: who submitted a job, its turn, the length of its lease; counters of rare events."""

import sqlalchemy as sa
from alembic import op

revision = "0004"
down_revision = "0003"
branch_labels = None
depends_on = None

TALLIES = ("lease_losses", "task_deaths", "poisoned")


def upgrade() -> None:
    op.add_column("jobs", sa.Column("submitter", sa.String(64), nullable=False, server_default=""))
    op.add_column("jobs", sa.Column("turn", sa.Integer, nullable=False, server_default="0"))
    op.add_column("jobs", sa.Column("lease_s", sa.Double))
    op.execute("UPDATE jobs SET turn = seq")  # the earlier order: an older database names no submitters
    op.drop_index("ix_jobs_queue", "jobs")
    op.create_index("ix_jobs_queue", "jobs", ["status", "priority", "turn", "seq", "process_id"])
    op.create_index("ix_jobs_submitter", "jobs", ["submitter", "status", "priority", "turn"])
    op.create_index("ix_jobs_ended", "jobs", ["status", "finished_at"])
    tally = op.create_table(
        "tally",
        sa.Column("name", sa.String(64), nullable=False),
        sa.Column("number", sa.BigInteger, nullable=False),
        sa.PrimaryKeyConstraint("name", name="pk_tally"),
    )
    op.bulk_insert(tally, [{"name": name, "number": 0} for name in TALLIES])


def downgrade() -> None:
    op.drop_table("tally")
    op.drop_index("ix_jobs_ended", "jobs")
    op.drop_index("ix_jobs_submitter", "jobs")
    op.drop_index("ix_jobs_queue", "jobs")
    for column in ("lease_s", "turn", "submitter"):
        op.drop_column("jobs", column)
    op.create_index("ix_jobs_queue", "jobs", ["status", "priority", "seq"])
