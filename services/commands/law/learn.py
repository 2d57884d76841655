"""`sdt learn`: which joint moves what was seen, which task it was, and what the twin would have to say."""

import math
from dataclasses import asdict
from pathlib import Path

import click
import numpy as np

from predicates.learn import UP, Learned, learn
from predicates.learn.coupled import coupled
from predicates.learn.phases import Plain
from sdt_kg.errors import InputError
from sdt_kg.mechanism import Pose
from sdt_kg.numbers import number_in
from services.app import Service, load
from services.commands.completion.types import CONTAINER, KITCHEN
from services.commands.exits import Exit
from services.commands.law.learned import (
    CANDIDATE_COLUMNS,
    candidate_rows,
    following_row,
    kitchen_row,
    learned_row,
    proposal_row,
    show_following,
    show_kitchen,
    show_learned,
)
from services.commands.options import KITCHEN_HELP, OutFile, csv_flag, json_flag, states_option
from services.commands.show import csv_is_asked, print_json, print_rows
from services.commands.verdicts import Json
from services.learning import (
    branch_triples,
    held_by,
    placed,
    proposal_for,
    seen_in,
    together_held,
    together_in,
    together_triples,
    with_held,
    write_branch,
)
from services.tracks import read_track


@click.command("learn")
@click.argument("track", type=click.Path(path_type=Path))
@click.option("--kitchen", metavar="KITCHEN", type=KITCHEN, help=KITCHEN_HELP)
@click.option(
    "--container",
    type=CONTAINER,
    metavar="NAME",
    help="Whose motion it is; without it, the one that fits best.",
)
@states_option
@click.option(
    "--at",
    metavar="X,Y,Z,QX,QY,QZ,QW",
    help="Pose of the track's frame in the kitchen's root frame [m, quaternion]; without it, they are one.",
)
@click.option(
    "--up",
    default="0,0,1",
    show_default=True,
    metavar="X,Y,Z|none",
    help="Up in the track's frame: axes are expected upright or level; none where it is not known.",
)
@click.option("--topic", metavar="TOPIC", help="ROS bags: the topic that has the poses.")
@click.option("--frame", metavar="FRAME", help="ROS bags: the TF frame that is meant.")
@click.option(
    "--with",
    "other",
    type=click.Path(path_type=Path),
    metavar="TRACK",
    help="A second track, seen at the same times: both joints, and whether the second follows the first. "
    "With a kitchen, the twin in which it does is proposed, with the joints that it does not have right.",
)
@click.option(
    "--with-container",
    "other_container",
    type=CONTAINER,
    metavar="NAME",
    help="Whose motion the second track is; without it, the one that fits best.",
)
@click.option("--accept", is_flag=True, help="Write the proposed twin. Without it nothing is accepted.")
@click.option(
    "-o",
    "--output",
    type=OutFile(),
    metavar="BRANCH.trig",
    help="Where --accept writes; CONTAINER.learned.trig if not said.",
)
@csv_flag
@json_flag
def learn_command(
    *,
    track: Path,
    kitchen: str | None,
    container: str | None,
    states: tuple[str, ...],
    at: str | None,
    up: str,
    topic: str | None,
    frame: str | None,
    other: Path | None,
    other_container: str | None,
    accept: bool,
    output: Path | None,
    as_json: bool,
) -> None:
    """Learn from TRACK, an observed motion of a handle or any other point.

    TRACK has columns x y z [m], optional t [s] before, qx qy qz qw and fx fy fz [N] after them, or a header
    with these names; or it is an .npz, an .mcap or the folder of a ROS 2 bag. With a kitchen: which known
    task it satisfies and whether the twin can replay it; where not, the twin that could is proposed.

    Exit 0 done, 1 the twin cannot replay the track and no other was accepted, 2 bad input.
    """
    _check_options(kitchen, (container, states, at, accept), (other, other_container), output, accept)
    learned = _learned(track, at, up, topic, frame)
    second = None if other is None else _learned(other, at, up)
    row = learned_row(learned, held_by(learned))
    if second is not None:
        row["second"] = learned_row(second, held_by(second))
        row["coupling"] = asdict(coupled(learned, second))
    if kitchen is not None:
        service = load(kitchen, state=states)
        follows = second is not None and row["coupling"]["holds"]
        row |= _in_kitchen(service, learned, container, output, accept and not follows)
        if second is not None and follows:
            row |= _coupled(service, (learned, second), (container, other_container), output, accept)
    _print(row, as_json)
    if kitchen is not None and not row["kitchen"]["replayed"] and not row["accepted"]:
        raise SystemExit(Exit.NO)


def _check_options(
    kitchen: str | None,
    of_kitchen: tuple[object, ...],
    other: tuple[Path | None, str | None],
    output: Path | None,
    accept: bool,
) -> None:
    if kitchen is None and any(of_kitchen):
        raise InputError("without a kitchen there is nothing to compare with", remedy="give --kitchen")
    if other[1] and not (other[0] and kitchen):
        raise InputError("--with-container without --with and --kitchen", remedy="give both")
    if output is not None and not accept:
        raise InputError("-o without --accept", remedy="say --accept to write the proposed twin")


def _learned(
    track: Path, at: str | None, up: str, topic: str | None = None, frame: str | None = None
) -> Learned:
    observed = read_track(track, topic=topic, frame=frame)
    return learn(observed if at is None else placed(observed, parse_pose(at)), parse_up(up))


def _print(row: Json, as_json: bool) -> None:
    if as_json:
        print_json(row)
    elif csv_is_asked():
        print_rows(candidate_rows(row), CANDIDATE_COLUMNS)
    else:
        _show(row)


def _show(row: Json) -> None:
    show_learned(row)
    if "second" in row:
        click.echo("\nsecond track")
        show_learned(row["second"])
    if "kitchen" in row:
        show_kitchen(row["kitchen"], row["proposal"])
        show_following(row.get("coupling_proposal"))
    if row.get("accepted"):
        click.echo(f"accepted: {row['accepted']}")


def _in_kitchen(
    service: Service, learned: Learned, container: str | None, output: Path | None, accept: bool
) -> Json:
    """What the track is in the kitchen; where the twin cannot replay it, what is proposed."""
    twin, physics = service.twin, service.physics
    seen = seen_in(twin, learned, physics, container)
    tasks = [str(each) for each in seen.explanation.tasks] if seen.fits else []
    row: Json = {"kitchen": kitchen_row(seen), "proposal": None, "accepted": None}
    proposal, branch, refusal = None, twin, ""
    if not seen.fits:
        proposal, after = proposal_for(twin, learned, seen, physics)
        branch, row["proposal"] = proposal.twin, proposal_row(proposal, after)
        tasks = list(row["proposal"]["tasks"])
        why = "; ".join(row["proposal"]["reasons"])
        refusal = "" if after.replayed else f"the proposed twin does not replay the track either: {why}"
    elif held_by(learned) is None or isinstance(held_by(learned), Plain):
        refusal = f"the twin has the path of {seen.followed.container.name} already"
    if accept and refusal:
        raise InputError(refusal, allowed="a track that shows what the twin does not know")
    if accept:
        path = output or Path(f"{seen.followed.container.name}.learned.trig")
        write_branch(path, with_held(branch, seen, learned), *branch_triples(twin, learned, seen, proposal))
        row["accepted"] = str(path)
    return row | {"task": ", ".join(tasks) or None}


def _coupled(
    service: Service,
    tracks: tuple[Learned, Learned],
    names: tuple[str | None, str | None],
    output: Path | None,
    accept: bool,
) -> Json:
    """The twin in which the second joint follows the first, and where it was written if it was accepted."""
    found = together_in(service.twin, tracks, service.physics, names)
    row: Json = {"coupling_proposal": following_row(found), "accepted": None}
    if accept and not found.replayed:
        raise InputError(
            "the proposed twin does not replay both tracks", allowed="tracks of joints that move as one"
        )
    if accept:
        path = output or Path(f"{found.following.container.name}.learned.trig")
        write_branch(path, together_held(tracks, found), *together_triples(service.twin, tracks, found))
        row["accepted"] = str(path)
    return row


def parse_up(text: str) -> np.ndarray | None:
    """Unit vector of `X,Y,Z`; None of `none`."""
    if text.strip().lower() == "none":
        return None
    up = _numbers(text)
    norm = math.hypot(*up)  # whose squares do not overflow
    if up.shape != (3,) or not np.isfinite(up).all() or not norm:
        raise InputError(f"'{text}' is no direction", allowed="X,Y,Z, for example 0,0,1, or none")
    return UP if np.array_equal(up, UP) else up / norm


def parse_pose(text: str) -> Pose:
    """Pose of `X,Y,Z` or `X,Y,Z,QX,QY,QZ,QW`."""
    numbers = _numbers(text)
    if numbers.shape == (3,):
        numbers = np.concatenate([numbers, [0.0, 0.0, 0.0, 1.0]])
    norm = math.hypot(*numbers[3:])
    if numbers.shape != (7,) or not np.isfinite(numbers).all() or abs(norm - 1) > 0.01:
        raise InputError(f"'{text}' is no pose", allowed="X,Y,Z or X,Y,Z,QX,QY,QZ,QW, a unit quaternion")
    x, y, z, qx, qy, qz, qw = (float(value) for value in (*numbers[:3], *numbers[3:] / norm))
    return Pose((x, y, z), (qx, qy, qz, qw))


def _numbers(text: str) -> np.ndarray:
    try:
        return np.array([number_in(part) for part in text.split(",")])
    except ValueError:
        return np.zeros(0)
