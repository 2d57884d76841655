"""What was learned from a track, as JSON and for people."""

import math
from dataclasses import asdict

import click

from predicates.learn import Articulation, Learned
from predicates.learn.articulation import SURE
from predicates.learn.phases import Latch, Plain, PushToOpen
from predicates.learn.proposal import Proposal
from sdt_kg.iri import local_name
from sdt_kg.mechanism import Joint, JointType
from services.commands.show import print_rows
from services.commands.terminal import console
from services.commands.verdicts import Json
from services.learning import Seen, SeenTogether

KINDS = {Plain: "plain", Latch: "latch", PushToOpen: "push_to_open"}
"""What held a container, by class."""

UNIT = {JointType.FIXED: "m", JointType.PRISMATIC: "m", JointType.REVOLUTE: "rad"}

SWUNG = math.radians(1)
"""[rad] By what gravity may turn an axis from where the track alone shows it, without being told."""


def learned_row(learned: Learned, phase: Latch | PushToOpen | Plain | None) -> Json:
    """What was learned, as JSON; vectors in the track's frame."""
    best, track = learned.best, learned.track
    candidates = [
        _candidate_row(each, probability)
        for each, probability in zip(learned.candidates, learned.probabilities, strict=True)
    ]
    return {
        **_joint_row(best),
        "sure": learned.sure,
        "samples": len(track.positions),
        "missing": track.missing,
        "outliers": best.outliers,
        "candidates": candidates,
        "mechanism": None if phase is None else {"kind": KINDS[type(phase)], **asdict(phase)},
        "task": None,
        "notes": _notes(learned),
    }


def _joint_row(joint: Articulation) -> Json:
    fixed, revolute = joint.joint_type is JointType.FIXED, joint.joint_type is JointType.REVOLUTE
    return {
        "joint_type": joint.joint_type.value,
        "axis": None if fixed else joint.axis.tolist(),
        "origin": joint.origin.tolist(),
        "radius": joint.radius if revolute else None,
        "limits": None if fixed else list(joint.limits),
        "unit": UNIT[joint.joint_type],
        "moved_less_than": joint.extent if fixed else None,
        "residual_rms": joint.residual_rms,
        "scale": joint.scale,
        "standard_deviations": {k: v for k, v in joint.deviations.items() if k != "zero"},
    }


def _candidate_row(joint: Articulation, probability: float) -> Json:
    return {**_joint_row(joint), "evidence": joint.evidence, "probability": probability}


def _notes(learned: Learned) -> list[str]:
    best, notes = learned.best, list[str]()
    if learned.track.missing:
        notes.append(f"{learned.track.missing} samples have no position and were left out")
    if not learned.track.timed:
        notes.append("the track has no times: its samples are taken in their order")
    if best.outliers:
        notes.append(f"{best.outliers} samples are farther than 5 scales from the path")
    if learned.probabilities[0] < SURE:
        second = learned.candidates[1].joint_type.value
        notes.append(f"unsure: {second} has the probability {learned.probabilities[1]:.2f}")
    if best.joint_type is JointType.FIXED:
        notes.append(f"a motion of less than {best.extent * 1000:.0f} mm is not excluded")
    if learned.poor:
        notes.append(
            f"unsure: {best.outliers} of {len(learned.track.positions)} samples lie off the path, "
            f"the others scatter by {best.scale * 1000:.1f} mm; too few show what moves"
        )
    notes += _swung(best)
    if best.joint_type is not JointType.FIXED:
        notes.append("limits are what was seen, not where the joint stops")
    return notes


def _swung(best: Articulation) -> list[str]:
    """What gravity says of the axis beside what the track does."""
    angle, spread = (math.degrees(each) for each in best.swung)
    if best.swung[0] <= SWUNG:
        return []
    shown = f"the track alone shows it {angle:.1f} ± {spread:.1f} degrees from there"
    return [f"the axis is taken to be {best.plumb.value}; {shown}: --up none takes that"]


def _held(mechanism: Json | None) -> str | None:
    """What held the container, for people."""
    if mechanism is None:
        return None
    if mechanism["kind"] == "plain":
        return f"friction of {mechanism['friction']:.1f} N"
    if mechanism["kind"] == "latch":
        threshold = f"{mechanism['force']:.1f} ± {mechanism['force_deviation']:.1f} N"
        return f"a latch that gives way at {threshold}, then friction of {mechanism['friction']:.1f} N"
    depth, out = mechanism["depth"] * 1000, mechanism["spring_out"] * 1000
    push = mechanism["force"]
    return f"a push-to-open: pushed in {depth:.1f} mm with {push:.1f} N, springs out {out:.0f} mm"


def _coupling(coupling: Json | None) -> str | None:
    """Whether a second joint follows, for people."""
    if coupling is None:
        return None
    if not coupling["holds"]:
        return f"the second track goes its own way (evidence {coupling['evidence']:.1f})"
    multiplier = f"{coupling['multiplier']:.3f} ± {coupling['multiplier_deviation']:.3f}"
    return f"the second joint is {multiplier} times this one, {coupling['offset']:+.3f}"


def show_learned(row: Json) -> None:
    """Print what was learned, for people."""
    unit, deviations = row["unit"], row["standard_deviations"]
    lines = {
        "joint": ("" if row["sure"] else "cannot tell; likeliest ")
        + row["joint_type"]
        + _moved(row["moved_less_than"]),
        "axis": _vector(row["axis"], deviations.get("axis"), "rad"),
        "origin": _vector(row["origin"], deviations.get("origin"), "m"),
        "radius": _figure(row["radius"], deviations.get("radius"), "m"),
        "seen": None if row["limits"] is None else f"{row['limits'][0]:.3f} to {row['limits'][1]:.3f} {unit}",
        "residual": f"{row['residual_rms'] * 1000:.1f} mm rms, noise {row['scale'] * 1000:.1f} mm",
        "samples": f"{row['samples']}, {row['missing']} missing, {row['outliers']} outliers",
        "held by": _held(row["mechanism"]),
        "coupling": _coupling(row.get("coupling")),
        "task": row["task"],
    }
    for name, text in lines.items():
        if text is not None:
            console().print(f"{name:<10}{text}", highlight=False)
    print_rows(row["candidates"], ("joint_type", "evidence", "probability", "residual_rms"))
    for note in row["notes"]:
        click.echo(f"note: {note}", err=True)


def _vector(values: list[float] | None, deviation: float | None, unit: str) -> str | None:
    if values is None:
        return None
    shown = ", ".join(f"{round(value, 3) + 0.0:.3f}" for value in values)  # + 0.0: no -0.000
    return f"({shown})" + (f" ± {deviation:.3f} {unit}" if deviation is not None else "")


def _moved(less_than: float | None) -> str:
    """What a joint that is taken to be fixed may have moved by all the same."""
    return "" if less_than is None else f", or moved less than {less_than * 1000:.0f} mm"


def _figure(value: float | None, deviation: float | None, unit: str) -> str | None:
    return None if value is None or deviation is None else f"{value:.3f} ± {deviation:.3f} {unit}"


def kitchen_row(seen: Seen) -> Json:
    """What a track is in a kitchen."""
    diagnoses = [each.reason for verdict in seen.explanation.verdicts for each in verdict.diagnoses]
    one = seen.followed
    return {
        "container": one.container.name,
        "joint": local_name(one.container.joint),
        "handle_distance": one.reach,
        "replayed": seen.replayed,
        "path_fits": seen.fits,
        "distance_median": float(sorted(one.distances)[len(one.distances) // 2]),
        "start": float(seen.motion.values[0, 0]),
        "end": float(seen.motion.values[-1, 0]),
        "time_stretch": None if math.isnan(seen.stretch) else seen.stretch,
        "tasks": [str(each) for each in seen.explanation.tasks] if seen.fits else [],
        "reasons": [] if seen.replayed else diagnoses,
    }


def proposal_row(proposal: Proposal, after: Seen) -> Json:
    """The joint that would allow what was seen, and whether the twin that has it replays it."""
    return {
        "joint": proposal.after.name,
        "before": _twin_joint_row(proposal.before),
        "after": _twin_joint_row(proposal.after),
        "seen": list(proposal.seen),
        "residual_rms": proposal.learned.residual_rms,
        "assumptions": list(proposal.assumptions),
        "replayed": after.replayed,
        "tasks": [str(each) for each in after.explanation.tasks] if after.fits else [],
        "reasons": [] if after.replayed else kitchen_row(after)["reasons"],
    }


def following_row(found: SeenTogether) -> Json:
    """The joint that would follow another, and whether the twin that has it replays both tracks."""
    made = found.following
    assert made.after.mimic is not None
    return {
        "joint": made.after.name,
        "follows": made.after.mimic.joint,
        "multiplier": made.after.mimic.multiplier,
        "multiplier_deviation": made.found.multiplier_deviation,
        "offset": made.after.mimic.offset,
        "residual": made.found.residual,
        "evidence": made.found.evidence,
        "assumptions": list(made.assumptions),
        "learned_before": [
            {
                "joint": each.after.name,
                "before": _twin_joint_row(each.before),
                "after": _twin_joint_row(each.after),
                "assumptions": list(each.assumptions),
            }
            for each in found.proposals
        ],
        "replayed": found.replayed,
    }


def show_following(row: Json | None) -> None:
    """Print a coupling that is proposed, for people."""
    if row is None:
        return
    times = f"times {row['multiplier']:.3f} ± {row['multiplier_deviation']:.3f}"
    then = "replays" if row["replayed"] else "still cannot replay"
    console().print(
        f"proposed  {row['joint']} follows {row['follows']}, {times}; the twin then {then} both tracks",
        highlight=False,
    )
    for each in row["learned_before"]:
        types = f"{each['before']['joint_type']} → {each['after']['joint_type']}"
        console().print(f"          with {each['joint']} as it was seen: {types}", highlight=False)
    for assumption in row["assumptions"]:
        console().print(f"          {assumption}", highlight=False)


CANDIDATE_COLUMNS = (
    *("joint_type", "evidence", "probability", "residual_rms"),
    *("best", "samples", "missing", "outliers", "container", "replayed", "task"),
)
"""Of a candidate on one line, with what holds of the whole track."""


def candidate_rows(row: Json) -> list[Json]:
    """A row for each candidate, the best first."""
    kitchen = row.get("kitchen") or {}
    whole = {name: row[name] for name in ("samples", "missing", "outliers", "task")}
    whole |= {name: kitchen.get(name) for name in ("container", "replayed")}
    return [{**each, **whole, "best": each is row["candidates"][0]} for each in row["candidates"]]


def _twin_joint_row(joint: Joint) -> Json:
    return {
        "joint_type": joint.type.value,
        "origin": list(joint.origin.position),
        "axis": list(joint.axis),
        "limits": [joint.limits.lower, joint.limits.upper],
        "parent": joint.parent,
    }


def show_kitchen(row: Json, proposal: Json | None) -> None:
    """Print what the track is in the kitchen, and what is proposed, for people."""
    print_line = console().print
    verdict = "replays it" if row["replayed"] else "cannot replay it"
    print_line(
        f"\nkitchen   {row['container']}, {row['start']:.3f} to {row['end']:.3f}: the twin {verdict},"
        f" median distance {row['distance_median'] * 1000:.1f} mm, limits aside",
        highlight=False,
    )
    print_line(f"tasks     {', '.join(row['tasks']) or 'none'}", highlight=False)
    for reason in row["reasons"]:
        print_line(f"          {reason}", highlight=False)
    if proposal is None:
        return
    before, after = proposal["before"], proposal["after"]
    low, high = after["limits"]
    print_line(
        f"proposed  {proposal['joint']}: {before['joint_type']} → {after['joint_type']},"
        f" axis {_vector(after['axis'], None, '')}, limits {low:.3f} to {high:.3f};"
        f" the twin then {'replays' if proposal['replayed'] else 'still cannot replay'} it",
        highlight=False,
    )
    print_line(f"tasks     {', '.join(proposal['tasks']) or 'none'} in the proposed twin", highlight=False)
    for assumption in [*proposal["assumptions"], *proposal["reasons"]]:
        print_line(f"          {assumption}", highlight=False)
