"""`sdt learn`: which joint moves what was seen, which task it was, and what the twin would have to say."""

from pathlib import Path

import click
import numpy as np

from predicates.learn import UP, Articulation, Learned, learn
from sdt_kg.errors import InputError
from sdt_kg.mechanism import JointType
from services.commands.options import json_flag
from services.commands.show import console, print_json, print_rows
from services.commands.verdicts import Json
from services.tracks import read_track

UNIT = {JointType.FIXED: "m", JointType.PRISMATIC: "m", JointType.REVOLUTE: "rad"}


@click.command("learn")
@click.argument("track", type=click.Path(path_type=Path))
@click.option(
    "--up",
    default="0,0,1",
    show_default=True,
    metavar="X,Y,Z|none",
    help="Up in the track's frame: axes are then expected upright or level; none where it is not known.",
)
@click.option("--topic", metavar="TOPIC", help="ROS bags: the topic that has the poses.")
@click.option("--frame", metavar="FRAME", help="ROS bags: the TF frame that is meant.")
@json_flag
def learn_command(*, track: Path, up: str, topic: str | None, frame: str | None, as_json: bool) -> None:
    """Learn from TRACK, an observed motion of a handle or any other point.

    TRACK has columns x y z [m], optional t [s] before, qx qy qz qw and fx fy fz [N] after them, or a header
    with these names; or it is an .npz, an .mcap or the folder of a ROS 2 bag.
    """
    learned = learn(read_track(track, topic=topic, frame=frame), parse_up(up))
    row = learned_row(learned)
    if as_json:
        print_json(row)
        return
    show_learned(row)


def parse_up(text: str) -> np.ndarray | None:
    """Unit vector of `X,Y,Z`; None of `none`."""
    if text.strip().lower() == "none":
        return None
    try:
        up = np.array([float(part) for part in text.split(",")])
    except ValueError:
        up = np.zeros(0)
    if up.shape != (3,) or not np.isfinite(up).all() or not np.linalg.norm(up):
        raise InputError(f"'{text}' is no direction", allowed="X,Y,Z, for example 0,0,1, or none")
    return UP if np.array_equal(up, UP) else up / np.linalg.norm(up)


def learned_row(learned: Learned) -> Json:
    """What was learned, as JSON; vectors in the track's frame."""
    best, track = learned.best, learned.track
    candidates = [
        _candidate_row(each, probability)
        for each, probability in zip(learned.candidates, learned.probabilities, strict=True)
    ]
    return {
        **_joint_row(best),
        "samples": len(track.positions),
        "missing": track.missing,
        "outliers": best.outliers,
        "candidates": candidates,
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
    if best.joint_type is not JointType.FIXED:
        notes.append("limits are what was seen, not where the joint stops")
    return notes


SURE = 0.95
"""[1] Below this probability the report says which other joint it may be."""


def show_learned(row: Json) -> None:
    """Print what was learned, for people."""
    unit, deviations = row["unit"], row["standard_deviations"]
    lines = {
        "joint": row["joint_type"],
        "axis": _vector(row["axis"], deviations.get("axis"), "rad"),
        "origin": _vector(row["origin"], deviations.get("origin"), "m"),
        "radius": _figure(row["radius"], deviations.get("radius"), "m"),
        "seen": None if row["limits"] is None else f"{row['limits'][0]:.3f} to {row['limits'][1]:.3f} {unit}",
        "residual": f"{row['residual_rms'] * 1000:.1f} mm rms, {row['scale'] * 1000:.1f} mm without outliers",
        "samples": f"{row['samples']}, {row['missing']} missing, {row['outliers']} outliers",
        "task": row["task"],
    }
    for name, text in lines.items():
        if text is not None:
            console().print(f"{name:<10}{text}", highlight=False)
    print_rows(row["candidates"], ("joint_type", "evidence", "probability", "residual_rms"), "table")
    for note in row["notes"]:
        click.echo(f"note: {note}", err=True)


def _vector(values: list[float] | None, deviation: float | None, unit: str) -> str | None:
    if values is None:
        return None
    shown = ", ".join(f"{value:.3f}" for value in values)
    return f"({shown})" + (f" ± {deviation:.3f} {unit}" if deviation is not None else "")


def _figure(value: float | None, deviation: float | None, unit: str) -> str | None:
    return None if value is None or deviation is None else f"{value:.3f} ± {deviation:.3f} {unit}"
