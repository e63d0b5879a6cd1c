"""``safestart convert``: a file of the field as another."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from safestart.cli.console import err
from safestart.cli.files import target
from safestart.errors import InvalidInput, invalid

_FORMS = {
    ".oem": "kvn", ".aem": "kvn", ".kvn": "kvn", ".xml": "xml", ".csv": "csv", ".parquet": "parquet", ".mat": "mat",
}  # fmt: skip


def register(app: typer.Typer) -> None:
    """Add the command."""

    @app.command("convert")
    def convert(
        source: Annotated[Path, typer.Argument(help="OEM, OPM, OCM, AEM, ACM, APM, CSV, Parquet or MATLAB.")],
        to: Annotated[
            Path, typer.Argument(help="Where to write; its ending says what: " + ", ".join(_FORMS) + ".")
        ],
        created: Annotated[
            str, typer.Option(help="CREATION_DATE of a message, UTC.")
        ] = "2000-01-01T00:00:00",
        sense: Annotated[
            str | None, typer.Option(help="rotating or inertial: how covariances in RTN are meant.")
        ] = None,
    ) -> None:
        """Write states or attitudes in another form, every number to the last bit; tables hold no covariance."""
        from safestart.interchange.ephemeris import Ephemeris
        from safestart.interchange.epochs import require_epoch
        from safestart.interchange.read import course_from
        from safestart.interchange.source import bytes_of
        from safestart.interchange.write import course_bytes

        if to.suffix.lower() not in _FORMS:
            raise invalid("to", f"a name that ends in one of {', '.join(_FORMS)}", to.name)
        if sense not in (None, "rotating", "inertial"):
            raise invalid("--sense", "rotating or inertial", sense)
        require_epoch("--created", created)
        form = _FORMS[to.suffix.lower()]
        course = course_from(bytes_of(source), source.name, sense)  # type: ignore[arg-type]
        plain = len(course.pieces) == 1 and not course.useable
        if isinstance(course, Ephemeris):
            plain = plain and not course.covariances
        if not plain and form not in ("kvn", "xml"):
            raise InvalidInput(
                "to: required a message for covariances, segments and useable times, received a table",
                field="to",
            )
        with target("to", to) as file:
            assert file is not None
            file.write(course_bytes(course, form, created))
        if course.left_out:
            err.print(f"left out: {', '.join(course.left_out)}", soft_wrap=True, markup=False)
        err.print(f"wrote {to}", soft_wrap=True, markup=False)
