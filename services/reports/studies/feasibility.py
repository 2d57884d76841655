"""Which robot achieves what in a kitchen: counts, matrix, margins, times, reasons."""

from collections import Counter

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Patch, Rectangle

from predicates.case import Outcome
from predicates.margins import CLEARANCES, LOOKED_UP_TO
from predicates.record.report import figures
from sdt_kg.motion import BodyMotion
from services.reports.pages.figure import Figure, drawn
from services.reports.pages.table import Cell, Table
from services.reports.scene.clip import Clip
from services.reports.scene.colors import COLORS
from services.reports.scene.paper import draw
from services.reports.scene.view import View
from services.reports.studies.judged import Judged, Judgements
from services.reports.studies.words import LETTERS, cell, color, failed, is_proved, reasons

TO_KITCHEN, TO_ITSELF = CLEARANCES
MARGINS = {
    TO_KITCHEN: ("to the kitchen", "mm", 1000.0),
    TO_ITSELF: ("to the robot itself", "mm", 1000.0),
    "base error tolerated": ("base error tolerated", "mm", 1000.0),
    "handle error tolerated": ("handle error tolerated", "mm", 1000.0),
}
"""Certified margins that are drawn: name → what it is, unit, units for one SI unit."""

MEANS = {
    "certified": "certified",
    "not_certified": "not certified",
    "proved": "proved impossible in D_artic",
    "abstained": "abstained",
}
"""What a colour says."""

ON_THE_WAY = "leave"
"""What comes between holds: letting go, leaving, driving back."""
PHASES = ("drive", "approach", "grasp", "follow", ON_THE_WAY)
SHADES = ("#c6ccd4", "#93a1b3", "#5d7189", "#26384f", "#b5651d")


def counts(found: Judgements) -> Table:
    """How many containers each robot achieves, and how the others fail."""
    rows = []
    for robot in found.robots:
        each = [one.verdict for one in found.of(robot)]
        kinds = Counter(failed(one) for one in each)
        rows.append(
            {
                "robot": robot,
                "certified": kinds["certified"],
                "of": len(each),
                "semantic": kinds["semantic"],
                "causal": kinds["causal"],
                "embodiment, proved": sum(failed(one) == "embodiment" and is_proved(one) for one in each),
                "embodiment, not proved": sum(
                    failed(one) == "embodiment" and not is_proved(one) for one in each
                ),
                "abstained": kinds["out of scope"],
            }
        )
    caption = (
        f"{found.verb}: containers that each robot is certified to {found.verb}, and the first failure of"
        " the others. 'Not proved' is a search that gave up: it denies nothing."
    )
    return Table.of("feasibility_counts", caption, rows)


def matrix(found: Judgements) -> Table:
    """Robots by containers, coloured; a certified field plays its motion in the 3D view."""
    by = {(one.robot, one.container.iri): one for one in found.all}
    rows = [
        (container.name, container.kind, *(_field(found, by[robot, container.iri]) for robot in found.robots))
        for container in [one.container for one in found.of(found.robots[0])]
    ]
    caption = (
        "Every verdict. A certified field plays its motion in the view; the others have their reason below."
    )
    return Table("feasibility_matrix", caption, ("container", "kind", *found.robots), tuple(rows))


def _field(found: Judgements, one: Judged) -> Cell:
    return cell(one.verdict, found.clip_name(one) if one.motion is not None else "")


def matrix_figure(found: Judgements) -> Figure:
    """The matrix as a figure for a paper: colour, and a letter for the kind of failure."""
    containers = [one.container for one in found.of(found.robots[0])]
    kitchen = found.service.twin.name(found.service.twin.environment)
    longest = max(len(each.name) for each in containers)
    with drawn(0.22 * len(found.robots) + 0.075 * longest + 0.5) as drawing:
        axes = drawing.add_subplot()
        for row, robot in enumerate(found.robots):
            for column, one in enumerate(found.of(robot)):
                axes.add_patch(_square(column, row, COLORS[color(one.verdict)]))
                letter = LETTERS[failed(one.verdict)] if not one.certified else ""
                axes.text(column, row, letter, ha="center", va="center", fontsize=6.5)
        axes.set(xlim=(-0.5, len(containers) - 0.5), ylim=(len(found.robots) - 0.5, -0.5))
        axes.set_xticks(range(len(containers)), [each.name for each in containers], rotation=90, fontsize=6.5)
        axes.set_yticks(range(len(found.robots)), found.robots)
        axes.grid(visible=False)
        axes.tick_params(length=0)
        axes.spines[:].set_visible(False)
        shown = {color(one.verdict) for one in found.all}
        handles = [Patch(facecolor=COLORS[name], label=text) for name, text in MEANS.items() if name in shown]
        axes.legend(handles=handles, loc="lower left", bbox_to_anchor=(0, 1.0), ncols=4, borderaxespad=0.2)
    caption = (
        f"{found.verb} in kitchen {kitchen}. S, C, E: SatisfiesRequest, Causes, CanPerform is the first"
        " that fails; A: abstained, outside D_artic."
    )
    return Figure("feasibility_matrix", caption, drawing)


def _square(column: int, row: int, color: tuple[float, float, float]) -> Patch:
    return Rectangle((column - 0.46, row - 0.44), 0.92, 0.88, facecolor=color, edgecolor="none")


def margins(found: Judgements) -> Figure:
    """What the certified motions keep: one dot for each, and their median."""
    with drawn(1.9) as drawing:
        for axes, (name, (title, unit, scale)) in zip(
            drawing.subplots(1, len(MARGINS), sharey=True), MARGINS.items(), strict=True
        ):
            for row, robot in enumerate(found.robots):
                values = [
                    scale * figures(one.verdict)[name][0]
                    for one in found.of(robot)
                    if name in figures(one.verdict)
                ]
                _strip(axes, row, values)
            axes.set_title(title)
            axes.set_xlabel(unit)
            axes.set_xlim(left=0)
        axes.set_yticks(range(len(found.robots)), found.robots)
        axes.set_ylim(len(found.robots) - 0.5, -0.5)
    caption = (
        "Margins of the certified motions, between the samples too: a dot for each motion, a stroke at the"
        f" median. Distances are not looked at above {1000 * LOOKED_UP_TO:g} mm: a dot there stands for at"
        " least that. Tolerated errors: how far base and handle may be from where the twin has them."
    )
    return Figure("feasibility_margins", caption, drawing)


def _strip(axes: Axes, row: int, values: list[float]) -> None:
    """Dots side by side in the order of their values, so that equal ones are seen."""
    offsets = 0.5 * (np.modf(np.arange(len(values)) * 0.618)[0] - 0.5)
    axes.plot(sorted(values), row + offsets, ".", color="#3c5a7d", markersize=3.5, alpha=0.75)
    if values:
        axes.plot([np.median(values)] * 2, [row - 0.36, row + 0.36], color="#c22026", linewidth=1.6)


def durations(found: Judgements) -> Figure:
    """How long each certified motion takes, phase by phase."""
    with drawn(0.55 * len(found.robots) + 0.9) as drawing:
        axes = drawing.add_subplot()
        shown = set[str]()
        for row, robot in enumerate(found.robots):
            left = 0.0
            spent = [seconds(one.motion) for one in found.of(robot) if one.motion is not None]
            for phase, shade in zip(PHASES, SHADES, strict=True):
                median = float(np.median([each[phase] for each in spent])) if spent else 0.0
                axes.barh(row, median, left=left, height=0.62, color=shade)
                left += median
                shown |= {phase} if median else set()
        axes.set_yticks(range(len(found.robots)), found.robots)
        axes.set_ylim(len(found.robots) - 0.5, -0.5)
        axes.grid(visible=False, axis="y")
        axes.set_xlabel("s, median over the certified motions of each phase")
        shades = zip(PHASES, SHADES, strict=True)
        handles = [Patch(facecolor=shade, label=phase) for phase, shade in shades if phase in shown]
        if handles:
            axes.legend(handles=handles, loc="lower left", bbox_to_anchor=(0, 1.0), ncols=len(PHASES))
    return Figure("feasibility_durations", "Where the time of a certified motion goes.", drawing)


def seconds(motion: BodyMotion) -> dict[str, float]:
    """Duration of each phase of a certified motion, over all holds [s]."""
    begins = [first for _, first in motion.phases]
    spent: dict[str, float] = dict.fromkeys(PHASES, 0.0)
    for (name, first), end in zip(motion.phases, [*begins[1:], len(motion.times) - 1], strict=True):
        phase = name.rstrip(" 0123456789")  # those of later holds are numbered
        spent[phase if phase in PHASES else ON_THE_WAY] += float(motion.times[end] - motion.times[first])
    return spent


def refusals(found: Judgements) -> Table:
    """Every verdict that is not certified, with all its reasons."""
    rows = [
        {
            "robot": one.robot,
            "container": one.container.name,
            "verdict": cell(one.verdict),
            "why": reasons(one.verdict),
            "seconds": one.verdict.seconds,
        }
        for one in found.all
        if one.verdict.outcome is not Outcome.CERTIFIED
    ]
    return Table.of("feasibility_refusals", "What is not certified, and why.", rows)


def picture(view: View, clip: Clip | None = None) -> Figure:
    """A moment of a view, for paper."""
    with drawn(3.6) as drawing:
        axes = drawing.add_subplot()
        draw(axes, view, clip or view.clips[0])
    shown = clip or view.clips[0]
    return Figure("feasibility_scene", f"{shown.name}: the end of its motion.", drawing)
