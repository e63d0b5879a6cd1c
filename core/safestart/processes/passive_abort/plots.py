"""Picture of a missed-burn proof: the drifts in the orbit plane, and the distance that every burn keeps."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Polygon
from matplotlib.ticker import MaxNLocator

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
_SAMPLES = 240
_MEMBERS = 12
_OUTLINE = 180


@drawn_as("aborts.png")
def picture(proof: Proof) -> Figure:
    """Left: free drifts after every burn, some members of each set, coloured by the proof. Right: distances."""
    drawing = figure(12.0, 5.2)
    plane, bars = drawing.subplots(1, 2, width_ratios=(1.25, 1.0))
    keep_out = proof.question.keep_out
    draw_drifts(plane, proof, range(len(proof.findings)))
    _distances(bars, proof)
    motion = "true" if proof.question.earth else "linear" if proof.question.radius is None else "nonlinear"
    verdict = {
        Verdict.PROVED: f"proved: at no time nearer than {proof.least:.2f} m",
        Verdict.VIOLATED: f"violated: a flight within the errors comes nearer than {keep_out:g} m",
        Verdict.UNKNOWN: f"unknown: {proof.gap:.2f} m of {keep_out:g} m are not proved",
    }[proof.verdict]
    drawing.suptitle(f"Burns that fail, {motion} motion; {verdict}", fontsize=11)
    return drawing


def draw_drifts(axes: Axes, proof: Proof, which: range) -> None:
    """Drifts of missed burns in the orbit plane, V-bar to the left as the target flies to the left, nadir down."""
    keep_out = proof.question.keep_out
    outlines = [_outline(zone, keep_out) for zone in proof.question.zones]
    marks = [1.5 * point for outline in outlines for point in (outline.min(axis=0), outline.max(axis=0))]
    for k in which:
        finding = proof.findings[k]
        if finding.case.kind not in ("start", "made"):
            continue
        colour = COLOURS["PROVED" if finding.least >= keep_out else _refuted(finding, keep_out)]
        paths = _paths(proof.question, finding.case)
        for path in paths:
            axes.plot(path[:, 1], path[:, 0], color=colour, linewidth=0.6, alpha=0.45)
        start = paths[0][0]
        axes.plot(start[1], start[0], marker="x", color="#222222", markersize=6, zorder=6)
        marks.append(start[:2])
    for zone, outline in zip(proof.question.zones, outlines, strict=True):
        axes.add_patch(Polygon(outline[:, ::-1], facecolor="#F6D5D0", edgecolor="#8C2B1D", zorder=1))
        if zone != POINT:
            axes.add_patch(Polygon(_outline(zone, 0.0)[:, ::-1], facecolor="#D98C7E", zorder=1))
    axes.plot(0.0, 0.0, marker="s", color="#333333", markersize=4, zorder=5)
    axes.set_aspect("equal")
    low, high = np.min(marks, axis=0), np.max(marks, axis=0)
    room = 0.3 * float((high - low).max())
    axes.set_xlim(high[1] + room, low[1] - room)
    axes.set_ylim(low[0] - room, high[0] + room)
    axes.set_xlabel("along-track y [m] (the target flies to the left)")
    axes.set_ylabel("radial x [m] (Earth below)")
    axes.set_title("free drift after each missed burn: members of its set", fontsize=10)
    for name, colour in COLOURS.items():
        axes.plot([], [], color=colour, label=name.lower())
    axes.legend(fontsize=8, loc="upper right")


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
    shown: set[str] = set()
    lowest: dict[tuple[int, str], Finding] = {}
    for finding in proof.findings:
        name = _NAMES.get(finding.case.kind, finding.case.kind)
        key = finding.case.burn + (1 if name == "missed" else 0), name
        kept = lowest.get(key)
        if kept is None or finding.least < kept.least:
            lowest[key] = finding
    for (burn, name), finding in sorted(lowest.items()):
        colour = COLOURS["PROVED" if finding.least >= keep_out else _refuted(finding, keep_out)]
        mark = _MARKS[finding.case.kind]
        axes.plot(
            burn, max(finding.least, 0.01 * keep_out), marker=mark, color=colour, linestyle="", markersize=6
        )
        if name not in shown:
            axes.plot([], [], marker=mark, color="#777777", linestyle="", label=name)
            shown.add(name)
    axes.axhline(keep_out, color="#8C2B1D", linewidth=1.0)
    axes.set_yscale("log")
    axes.annotate(f"keep out: {keep_out:g} m", (0.02, keep_out), xycoords=("axes fraction", "data"), fontsize=8,
                  va="bottom", color="#8C2B1D")  # fmt: skip
    axes.set_xlabel("burn that fails (the last mark: drift after the last burn)")
    axes.set_ylabel("least distance proved [m]")
    axes.xaxis.set_major_locator(MaxNLocator(integer=True))
    axes.set_title("what each failure keeps", fontsize=10)
    axes.legend(fontsize=8)
