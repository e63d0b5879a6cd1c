"""Picture of a missed-burn proof: the drifts in the orbit plane, and the distance that every burn keeps."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Polygon
from matplotlib.ticker import FuncFormatter, LogLocator, MaxNLocator, NullFormatter

from safestart.dynamics.cwh import transition_matrix
from safestart.dynamics.two_body_kernel import STAGES, WEIGHTS, drifted, seen
from safestart.missed_burn.earth.motion import target_before
from safestart.missed_burn.plan import Question
from safestart.missed_burn.prove import Finding, Proof, Verdict
from safestart.missed_burn.sets import Case
from safestart.missed_burn.zone import POINT, Zone
from safestart.model.scenario import Floats
from safestart.processes.plotting import drawn_as, figure

COLOURS = {"PROVED": "#1B7F3B", "VIOLATED": "#C0392B", "UNKNOWN": "#B7791F"}
_MARKS = {
    "start": "o",
    "made": "o",
    "cut": "P",
    "partial": "s",
    "misdirected": "^",
    "late": "D",
    "stuck": "v",
}
_NAMES = {"start": "missed", "made": "missed", "cut": "cut short"}
_KINDS = {_NAMES.get(kind, kind): kind for kind in _MARKS}
_ORDER = tuple(_KINDS)
_BESIDE = 0.6
"""Width over which the failures of a burn are spread, in burns."""
_TITLE, _LABEL = 20, 15
_WIDE = 1.9
"""Width of the upper panel over its height."""
_SAMPLES = 240
_MEMBERS = 12
_OUTLINE = 180


@drawn_as("aborts.png")
def picture(proof: Proof) -> Figure:
    """Left: free drifts after every burn, some members of each set, coloured by the proof. Right: distances."""
    # Two panels, one above the other, in letters that can be read where the picture is a few centimetres wide.
    drawing = figure(8.0, 9.0)
    plane, bars = drawing.subplots(2, 1, height_ratios=(1.25, 1.0))
    keep_out = proof.question.keep_out
    draw_drifts(plane, proof, range(len(proof.findings)))
    _distances(bars, proof)
    motion = "true" if proof.question.earth else "linear" if proof.question.radius is None else "nonlinear"
    verdict = {
        Verdict.PROVED: f"PROVED: never nearer than {proof.least:.1f} m",
        Verdict.VIOLATED: f"VIOLATED: a flight comes nearer than {keep_out:g} m",
        Verdict.UNKNOWN: f"UNKNOWN: {proof.gap:.1f} m of {keep_out:g} m not proved",
    }[proof.verdict]
    colour = COLOURS[proof.verdict.value]
    drawing.suptitle(f"{verdict}\nburns that fail, {motion} motion", fontsize=_TITLE, color=colour)
    return drawing


def draw_drifts(axes: Axes, proof: Proof, which: range) -> None:
    """Drifts of missed burns in the orbit plane, V-bar to the left as the target flies to the left, nadir down."""
    keep_out = proof.question.keep_out
    outlines = [_outline(zone, keep_out) for zone in proof.question.zones]
    marks = [point for outline in outlines for point in (outline.min(axis=0), outline.max(axis=0))]
    drawn: list[Floats] = []
    shown: set[str] = set()
    for k in which:
        finding = proof.findings[k]
        if finding.case.kind not in ("start", "made"):
            continue
        word = "PROVED" if finding.least >= keep_out else _refuted(finding, keep_out)
        paths = _paths(proof.question, finding.case)
        for path in paths:
            label = "_" if word in shown else word.lower()
            shown.add(word)
            axes.plot(path[:, 1], path[:, 0], color=COLOURS[word], linewidth=1.2, alpha=0.5, label=label)
        drawn += paths
        start = paths[0][0]
        axes.plot(
            start[1], start[0], marker="x", color="#222222", markersize=11, markeredgewidth=2.5, zorder=6
        )
        marks.append(start[:2])
    for zone, outline in zip(proof.question.zones, outlines, strict=True):
        axes.add_patch(Polygon(outline[:, ::-1], facecolor="#F6D5D0", edgecolor="#8C2B1D", zorder=1))
        if zone != POINT:
            axes.add_patch(Polygon(_outline(zone, 0.0)[:, ::-1], facecolor="#D98C7E", zorder=1))
    axes.plot(0.0, 0.0, marker="s", color="#333333", markersize=9, zorder=5)
    _framed(
        axes, np.array(marks), np.concatenate([path[:, :2] for path in drawn]) if drawn else np.zeros((0, 2))
    )
    axes.set_xlabel("along-track y [m], flight to the left", fontsize=_LABEL)
    axes.set_ylabel("radial x [m], Earth below", fontsize=_LABEL)
    axes.tick_params(labelsize=_LABEL)
    axes.set_title("drifts after a missed burn (burns: x)", fontsize=_LABEL)
    axes.legend(fontsize=_LABEL, loc="best")


def _framed(axes: Axes, marks: Floats, paths: Floats) -> None:
    """Limits that show all ``marks`` (N, 2) and as much of the ``paths`` (P, 2) as leaves those readable; radial and
    along-track, m, to one scale."""
    low, high = marks.min(axis=0), marks.max(axis=0)
    room = 0.35 * float((high - low).max())
    if len(paths):
        low = np.minimum(low, np.maximum(paths.min(axis=0), low - room))
        high = np.maximum(high, np.minimum(paths.max(axis=0), high + room))
    # To the panel's shape, so that it is filled.
    middle, half = 0.5 * (low + high), 0.55 * (high - low)
    radial = max(float(half[0]), float(half[1]) / _WIDE)
    axes.set_aspect("equal")
    axes.set_xlim(middle[1] + _WIDE * radial, middle[1] - _WIDE * radial)
    axes.set_ylim(middle[0] - radial, middle[0] + radial)


def _outline(zone: Zone, around: float) -> Floats:
    """The zone with ``around`` m around it, seen along the orbit's normal: points (N, 2), radial and along-track."""
    turns = np.linspace(0.0, 2.0 * np.pi, _OUTLINE, endpoint=False)
    d, axes = np.stack([np.cos(turns), np.sin(turns)], axis=1), np.array(zone.axes)[:, :2]
    along = d @ axes.T
    if zone.kind == "box":
        share = np.sign(along)
    else:
        size = np.linalg.norm(along, axis=1, keepdims=True)
        share = along / np.where(size > 0.0, size, 1.0)
    outline: Floats = np.array(zone.centre[:2]) + share @ axes + around * d
    return outline


def _refuted(finding: Finding, keep_out: float) -> str:
    return "VIOLATED" if finding.nearest < keep_out else "UNKNOWN"


def _paths(question: Question, case: Case) -> list[Floats]:
    """LVLH paths (T, 6) of the centre, of members at corners of the boxes, drawn by a fixed pattern."""
    times = np.linspace(0.0, case.duration, _SAMPLES)
    rng = np.random.default_rng(7)
    members = [case.centre]
    for _ in range(_MEMBERS if len(case.columns) else 0):
        member, begin = case.centre.copy(), 0
        for end in case.ends.tolist():
            share = rng.standard_normal(end - begin)
            member = member + (share / np.linalg.norm(share)) @ case.columns[begin:end]
            begin = end
        members.append(member)
    if question.earth is not None:
        target = target_before(question, max(case.burn, 0))
        return [_flown(np.concatenate([target, member]), times[1]) for member in members]
    matrices = np.array([transition_matrix(question.plan.mean_motion, float(t)) for t in times])
    return [matrices @ member for member in members]


def _flown(flight: Floats, seconds: float) -> Floats:
    """The path about the true Earth, looked at every so many seconds."""
    path = [seen(flight)]
    for _ in range(_SAMPLES - 1):
        flight, _ = drifted(flight, seconds, STAGES, WEIGHTS)
        path.append(seen(flight))
    return np.array(path)


def _distances(axes: Axes, proof: Proof) -> None:
    keep_out = proof.question.keep_out
    lowest: dict[tuple[int, str], Finding] = {}
    for finding in proof.findings:
        name = _NAMES.get(finding.case.kind, finding.case.kind)
        key = finding.case.burn + (1 if name == "missed" else 0), name
        kept = lowest.get(key)
        if kept is None or finding.least < kept.least:
            lowest[key] = finding
    # Failures of one burn beside each other.
    names = [name for name in _ORDER if any(name == key[1] for key in lowest)]
    for (burn, name), finding in sorted(lowest.items()):
        colour = COLOURS["PROVED" if finding.least >= keep_out else _refuted(finding, keep_out)]
        aside = (names.index(name) + 0.5) / len(names) - 0.5
        at, kept_m = burn + _BESIDE * aside, max(finding.least, 0.01 * keep_out)
        axes.plot(at, kept_m, marker=_MARKS[finding.case.kind], color=colour, linestyle="", markersize=10)
    for name in names:
        axes.plot(
            [], [], marker=_MARKS[_KINDS[name]], color="#777777", linestyle="", markersize=10, label=name
        )
    axes.axhline(keep_out, color="#8C2B1D", linewidth=2.0)
    axes.set_yscale("log")
    least, most = axes.get_ylim()
    # Room for the names of the failures above the marks.
    axes.set_ylim(least, most * (most / least) ** 0.35)
    axes.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axes.yaxis.set_minor_formatter(NullFormatter())
    axes.set_xlim(-0.5, max(burn for burn, _ in lowest) + 0.5)
    axes.annotate(f"keep out {keep_out:g} m", (0.02, keep_out), xycoords=("axes fraction", "data"), fontsize=_LABEL,
                  va="bottom", color="#8C2B1D")  # fmt: skip
    axes.set_xlabel("burn that fails (last: drift after all)", fontsize=_LABEL)
    axes.set_ylabel("proved distance [m]", fontsize=_LABEL)
    axes.xaxis.set_major_locator(MaxNLocator(integer=True))
    axes.tick_params(which="both", labelsize=_LABEL)
    axes.legend(fontsize=_LABEL, ncols=3, loc="upper center")
