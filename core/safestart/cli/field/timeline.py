"""``safestart timeline``: when may the approach start? From the files of chaser and target."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated, Any

import typer

from safestart.cli.console import Json, err, out, print_json, reporting
from safestart.cli.files import Folder, folder, target
from safestart.errors import invalid
from safestart.processes.base import WireModel
from safestart.processes.execute import Execution
from safestart.processes.registry import process
from safestart.processes.side_by_side import execute_side_by_side
from safestart.runtime.plain_json import loads

_COLOURS = {"GO": "green", "NO_GO": "red", "UNDECIDED": "yellow"}
_MOST_SHOWN = 20
_FEW = 1000


def register(app: typer.Typer) -> None:
    """Add the command."""

    @app.command("timeline")
    def timeline(
        chaser: Annotated[Path, typer.Option(help="States of the chaser: OEM, OCM, CSV, Parquet or MATLAB.")],
        target_file: Annotated[Path, typer.Option("--target", help="States of the target: the same.")],
        a_max: Annotated[
            float, typer.Option("--a-max", help="Maximum thrust acceleration of the chaser, m/s^2.")
        ],
        attitude: Annotated[
            Path | None,
            typer.Option(help="Attitude of the target: AEM, CSV, Parquet or MATLAB; else --spin."),
        ] = None,
        spin: Annotated[
            float | None, typer.Option(help="Steady spin of the target about LVLH z, deg/s; else --attitude.")
        ] = None,
        phase: Annotated[
            float, typer.Option(help="By how much the spin is ahead of LVLH at the start, deg.")
        ] = 0.0,
        corridor: Annotated[
            list[str] | None,
            typer.Option(
                help='JSON of a corridor, such as {"name": "aft", "axis": [0, -1, 0]}; may be repeated.'
            ),
        ] = None,
        start: Annotated[str | None, typer.Option(help="Begin of the span, UTC.")] = None,
        stop: Annotated[str | None, typer.Option(help="End of the span, UTC.")] = None,
        step: Annotated[float, typer.Option(help="Distance of the instants that are asked, s.")] = 10.0,
        bracket: Annotated[float, typer.Option(help="A change of verdict is closed in on to this, s.")] = 0.1,
        horizon: Annotated[float, typer.Option(help="How long to be able to stay, s.")] = 60.0,
        sense: Annotated[
            str | None, typer.Option(help="rotating or inertial: how covariances in RTN are meant.")
        ] = None,
        confidence: Annotated[
            float | None,
            typer.Option(
                help="Ask for every start in the box that holds the state with this probability (covariances)."
            ),
        ] = None,
        output: Annotated[
            Path | None, typer.Option(help="Where to write the document; picture and table go beside it.")
        ] = None,
        proofs: Annotated[
            Path | None,
            typer.Option(
                help="Directory for the proofs at the ends of the intervals; made where it is missing, its "
                "parent is not."
            ),
        ] = None,
        as_json: Json = False,
    ) -> None:
        """Intervals of GO, NO_GO and UNDECIDED over time, with proofs at their ends."""
        inputs: dict[str, Any] = {
            "chaser": _text("--chaser", chaser),
            "target": _text("--target", target_file),
            "a_max_m_s2": a_max,
            "step_s": step,
            "bracket_s": bracket,
            "horizon_s": horizon,
            "start": start,
            "stop": stop,
            "sense": sense,
            "confidence": confidence,
            "proofs": proofs is not None or output is not None,
        }
        if attitude is not None:
            inputs["attitude"] = _text("--attitude", attitude)
        if spin is not None:
            inputs["spin"] = {"rate_deg_s": spin, "phase_deg": phase}
        if corridor:
            inputs["corridors"] = [_corridor(text) for text in corridor]
        parsed = process("commit-timeline").parse(inputs)
        with target("--output", output) as file, folder("--proofs", proofs) as kept:
            with reporting("commit-timeline") as context:
                result = execute_side_by_side("commit-timeline", parsed, context, _workers(parsed))
            if file is not None:
                file.write_json(result.document, indent=2)
                for artifact in result.artifacts:
                    file.write_beside(artifact.name, artifact.data)
            if kept is not None:
                _write_proofs(kept, result)
        for item in file.written[1:] if file is not None else ():
            err.print(f"wrote {item}", soft_wrap=True, markup=False)
        if proofs is not None:
            err.print(f"wrote proofs to {proofs}", soft_wrap=True, markup=False)
        print_json(result.document) if as_json else _show(result.document["outputs"])


def _workers(inputs: WireModel) -> int | None:
    """1 for a span so short that other processes would not have started before it is done; None: as many as cores."""
    from safestart.processes.commit_timeline.courses import encounter_of
    from safestart.processes.commit_timeline.spec import CommitTimelineInputs

    assert isinstance(inputs, CommitTimelineInputs)
    return 1 if len(encounter_of(inputs)[1]) < _FEW else None


def _text(option: str, path: Path) -> str:
    """The text of a message, or of the OEM or AEM that a table comes to."""
    from safestart.interchange.source import bytes_of, text_of
    from safestart.interchange.tables import columns as tables
    from safestart.interchange.write import course_bytes

    data = bytes_of(path)
    if not tables.is_table(data, path.name):
        return text_of(data, option)
    read = tables.attitude_of if option == "--attitude" else tables.ephemeris_of
    return course_bytes(read(data, path.name), "kvn", "2000-01-01T00:00:00").decode()


def _corridor(text: str) -> Any:
    try:
        return loads(text)
    except (ValueError, RecursionError):
        raise invalid("--corridor", "JSON", text) from None


def _write_proofs(directory: Folder, result: Execution) -> None:
    """One file for each end of an interval, numbered in time: 001-GO-begin.json."""
    (kept,) = (artifact for artifact in result.artifacts if artifact.name == "proofs.json")
    found = json.loads(kept.data)
    for number, one in enumerate(result.document["outputs"]["intervals"], 1):
        for end in ("begin", "end"):
            digest = one[f"{end}_proof"]
            if digest is not None:
                directory.write_json(f"{number:03d}-{one['verdict']}-{end}.json", found[digest])


def _show(outputs: dict[str, Any]) -> None:
    out.print(f"{outputs['chaser']} to {outputs['target']}, {outputs['start']} .. {outputs['stop']} UTC")
    for one in outputs["intervals"][:_MOST_SHOWN]:
        colour = _COLOURS[one["verdict"]]
        out.print(
            f"  {one['begin']} .. {one['end']}  [bold {colour}]{one['verdict']}[/]  {one['corridor']}: {one['reason']}",
            soft_wrap=True,
        )
    left = len(outputs["intervals"]) - _MOST_SHOWN
    if left > 0:
        out.print(f"  and {left} more; --output writes them all")
    first = outputs["first_go"] or "none"
    out.print(f"first GO: {first}; {outputs['go_s']:.6g} s of GO")
