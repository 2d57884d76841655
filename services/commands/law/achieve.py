"""`sdt achieve`: CanAchieve for one task."""

from collections.abc import Mapping, Sequence
from contextlib import nullcontext
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import click

from predicates.case import Outcome, Verdict
from predicates.record import to_json
from sdt_kg.annotation import Drive
from sdt_kg.errors import InputError
from sdt_kg.load import model_name
from sdt_kg.motion import BodyMotion, Motion
from sdt_kg.task import UNKNOWN
from services.app import Policy, Service, load
from services.commands.completion.types import KITCHEN, ROBOT, TASK
from services.commands.options import (
    BODY_MOTION_FILE,
    KITCHEN_HELP,
    ROBOT_HELP,
    OutFile,
    annotation_option,
    any_start_option,
    base_option,
    budget_option,
    contact_option,
    csv_flag,
    drive_option,
    forces_option,
    friction_option,
    handle_force_option,
    json_flag,
    save_option,
    seed_option,
    states_option,
    tee_option,
)
from services.commands.show import progress
from services.commands.verdicts import hint_of_start, hint_of_velocities, told
from services.motions import check_format, read_arrays, read_motion, write_motion
from services.relative import in_class
from services.requests import parse_base, parse_task
from services.store.output import write_file

if TYPE_CHECKING:
    from services.store.files import SavedVerdicts


@click.command()
@click.option("--kitchen", required=True, type=KITCHEN, help=KITCHEN_HELP)
@click.option("--robot", required=True, type=ROBOT, help=ROBOT_HELP)
@click.option(
    "--task", required=True, type=TASK, metavar="TASK", help="open, close, open:CONTAINER, close:CONTAINER."
)
@click.option(
    "--motion",
    type=click.Path(exists=True, path_type=Path),
    metavar="FILE",
    help="Verify this motion, of a container or of the robot, instead of making one: .npz, .json, .csv or "
    "a ROS 2 bag (.mcap).",
)
@any_start_option
@contact_option
@friction_option
@states_option
@base_option
@drive_option
@tee_option
@forces_option
@handle_force_option
@annotation_option
@budget_option
@seed_option
@save_option
@click.option(
    "--motion-out",
    type=BODY_MOTION_FILE,
    metavar="FILE",
    help="Write the certified body motion: .npz, .json, .csv or a ROS 2 bag (.mcap).",
)
@click.option(
    "--certificate",
    type=OutFile(),
    metavar="FILE",
    help="Write what re-verifies the verdict, for sdt recheck.",
)
@csv_flag
@json_flag
def achieve(
    *,
    kitchen: str,
    robot: str,
    task: str,
    motion: Path | None,
    any_start: bool,
    contact: float | None,
    friction: float | None,
    states: tuple[str, ...],
    base: str | None,
    drive: str | None,
    tee: str,
    forces: Path | None,
    handle_force: float | None,
    annotation: str | None,
    budget: float,
    seed: int,
    save: str | None,
    motion_out: Path | None,
    certificate: Path | None,
    as_json: bool,
) -> None:
    """Can ROBOT achieve TASK in KITCHEN? Makes a motion, or verifies the one given.

    With --save, what was judged before is answered from there.

    Exit 0 all certified, 1 some not, 3 all abstained, 2 bad input.
    """
    if motion_out:
        check_format(motion_out)
    moves = Drive(drive) if drive else None
    policy = Policy(moves, parse_base(base), budget, seed, any_start, contact, friction)
    service = load(kitchen, [robot], annotation=annotation, state=states, policy=policy)
    service = in_class(service, tee, forces, handle_force)
    given = read_motion(motion, service.twin, service.robot(model_name(robot))) if motion else None
    of_all = parse_task(service.twin, task).container is UNKNOWN and given is None
    count = len(service.twin.containers()) if of_all else 1
    if count > 1:
        _refuse_one_file({"--motion-out": motion_out, "--certificate": certificate})
    # Verdicts are told before the store is closed: a file is written then, and may not fit.
    with _saved(save) if save is not None else nullcontext() as saved:
        if saved:
            saved.add_twin(service.twin)
            service = replace(service, recall=saved.stored)
        verdicts = _judged(service, (task, model_name(robot)), given, saved, count)
        if motion_out:
            _write_motion(verdicts, motion_out)
        if certificate:
            _write_certificate(verdicts, certificate)
        objects = [to_json(verdict) for verdict in verdicts]
        code = told(objects, as_json=as_json, given=given is not None)
        if motion and isinstance(given, BodyMotion) and not as_json:
            hint_of_start(objects, given.base[0])
            hint_of_velocities(objects, lambda: read_arrays(motion))
    raise SystemExit(code)


def _judged(
    service: Service,
    asked: tuple[str, str],
    given: Motion | BodyMotion | None,
    saved: "SavedVerdicts | None",
    count: int,
) -> list[Verdict]:
    """All verdicts about a task and a robot, each kept as soon as it is there; a bar on the way."""
    verdicts: list[Verdict] = []
    with progress(asked[0], count, "containers") if count > 1 else nullcontext() as bar:
        for verdict in service.achieve(*asked, motion=given):
            verdicts.append(verdict)
            if bar:
                bar.update(bar.task_ids[0], advance=1, now=verdict.outcome.value)
            if saved and not verdict.stored:
                saved.add(verdict)
    return verdicts


def _saved(place: str) -> "SavedVerdicts":
    from services.store.files import SavedVerdicts  # noqa: PLC0415 - imports what asks remote stores

    return SavedVerdicts(place)


def _refuse_one_file(files: Mapping[str, Path | None]) -> None:
    """Several verdicts do not go into one file."""
    for option in (name for name, path in files.items() if path):
        raise InputError(
            f"{option} takes one verdict", allowed="a task with a container, such as open:CONTAINER"
        )


def _write_certificate(verdicts: Sequence[Verdict], path: Path) -> None:
    answers = [verdict.can_perform for verdict in verdicts]
    artefacts = [each.artefact for each in answers if each is not None and each.artefact is not None]
    if len(verdicts) > 1:
        _refuse_one_file({"--certificate": path})
    if artefacts:
        write_file(path, artefacts[0].content)
    else:
        click.echo(f"{path} is not written: nothing was certified or proved", err=True)


def _write_motion(verdicts: Sequence[Verdict], path: Path) -> None:
    motions = [verdict.case.body_motion for verdict in verdicts if verdict.outcome is Outcome.CERTIFIED]
    if len(verdicts) > 1:
        _refuse_one_file({"--motion-out": path})
    if motions and isinstance(motions[0], BodyMotion):
        write_motion(path, motions[0])
    else:
        click.echo(f"{path} is not written: no certified motion", err=True)
