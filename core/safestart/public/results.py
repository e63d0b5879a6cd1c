"""`run`: any process of ours, in this Python, with a progress bar; its result."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from safestart.errors import invalid
from safestart.processes.registry import process
from safestart.processes.tables import Rows, typed_tables
from safestart.public.shown import frame_of, html_of
from safestart.records.artifact import Artifact
from safestart.runtime.files.whole import Whole

if TYPE_CHECKING:
    import os

    import pandas as pd


@dataclass(frozen=True, slots=True, eq=False)
class Result:
    """The result of a process: its document and its files.

    ``process_id`` names the process. ``document`` holds ``inputs``, ``outputs`` and ``provenance``; ``artifacts`` are
    pictures (PNG), arrays (NPZ) and tables (Parquet) with ``name``, ``media_type``, ``data`` and ``sha256``. A notebook
    shows the first picture.
    """

    process_id: str
    document: dict[str, Any]
    artifacts: tuple[Artifact, ...]

    @property
    def outputs(self) -> dict[str, Any]:
        """The outputs, units in their names."""
        found: dict[str, Any] = self.document["outputs"]
        return found

    @property
    def pictures(self) -> dict[str, bytes]:
        """The PNG files by name."""
        return {one.name: one.data for one in self.artifacts if one.media_type == "image/png"}

    def tables(self) -> dict[str, Rows]:
        """The tables of the outputs by name, the first the most important; each a list of rows."""
        return {name: table.as_rows() for name, table in typed_tables(self.document).items()}

    def to_dataframe(self, table: str = "") -> pd.DataFrame:
        """A table as a pandas data frame, by default the first.

        Raises ``InvalidInput`` for an unknown table, ``Unavailable`` if pandas is not installed.
        """
        tables = typed_tables(self.document)
        name = table or next(iter(tables), "")
        if name not in tables:
            raise invalid(
                "table", f"one of {', '.join(tables)}" if tables else "a process with tables", table
            )
        return frame_of(tables[name].cells)

    def save(self, folder: str | os.PathLike[str]) -> list[Path]:
        """Write the document (``result.json``) and the files into a folder; returns the paths.

        Raises ``OSError``, and then none of them has changed.
        """
        import json

        place = Path(folder)
        place.mkdir(parents=True, exist_ok=True)
        text = json.dumps(self.document, allow_nan=False, indent=2) + "\n"
        contents = {place / "result.json": text.encode()}
        contents |= {place / Path(one.name).name: one.data for one in self.artifacts}
        with Whole() as files:
            for path, data in contents.items():
                files.add(path, data)
        return list(contents)

    def _repr_png_(self) -> bytes | None:
        return next(iter(self.pictures.values()), None)

    def _repr_html_(self) -> str:
        scalars = {
            name: value
            for name, value in self.outputs.items()
            if isinstance(value, str | int | float | bool) and len(str(value)) <= 200
        }
        return html_of(self.process_id, {"process": self.process_id, **scalars}, self._repr_png_())


def run(process_id: str, inputs: Mapping[str, Any] | None = None, *, progress: bool = True) -> Result:
    """Run a process here; inputs are those of ``POST /processes/{id}/execution`` (docs/api.md), units in their names.

    ``progress`` shows a bar on standard error. Raises ``NotFound`` for an unknown process, ``InvalidInput`` for inputs
    outside its description.
    """
    from safestart.processes.execute import execute
    from safestart.runtime.progress import Context

    if not isinstance(inputs, Mapping | None):
        raise invalid("inputs", "an object of names and values", inputs)
    given = dict(inputs or {})
    parsed = process(process_id).parse(given)
    if not progress:
        found = execute(process_id, parsed, Context())
    else:
        from rich.console import Console

        from safestart.runtime.reporting import reporting_on

        with reporting_on(Console(stderr=True, highlight=False), process_id) as context:
            found = execute(process_id, parsed, context)
    return Result(process_id, found.document, found.artifacts)
