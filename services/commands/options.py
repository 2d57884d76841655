"""Options that several subcommands share, each spelled once."""

import math
import os
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

import click

from sdt_kg.endless import check_ends
from sdt_kg.errors import InputError
from sdt_kg.numbers import check_written
from services.commands.completion.types import KITCHEN, STATE
from services.commands.show import CSV
from services.policy import LEAST_FRICTION, MOST_CONTACT, MOST_FRICTION, NOT_HELD
from services.store.output import check_file, check_folder

Decorated = TypeVar("Decorated", bound=Callable[..., Any])  # click's own: whatever a command is made of

KITCHEN_HELP = "Bundled kitchen (a, b) or path of a URDF, xacro, MJCF, SDF or saved twin (.nq, .trig)."
ROBOT_HELP = "Bundled robot (pr2, tiago_dual, stretch) or path of a URDF or xacro."


def query_text(file: Path) -> str:
    """The query in a file, with or without the mark that Windows begins a text with.

    Raises:
        InputError: It is no UTF-8, or not there.
    """
    check_ends(file)
    try:
        return file.read_text(encoding="utf-8-sig")
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"{file} cannot be read: {error}", allowed="SPARQL in UTF-8") from None


class WholeRange(click.IntRange):
    """A whole number inside a range, written as people write it: of `1_0` Python makes 10."""

    def convert(self, value: int, param: click.Parameter | None, ctx: click.Context | None) -> int:
        """The number."""
        _check_written(self, value, param, ctx)
        return super().convert(value, param, ctx)


class FiniteRange(click.FloatRange):
    """A number inside a range; what is no number is outside every range, and Python would let it in."""

    def convert(self, value: float, param: click.Parameter | None, ctx: click.Context | None) -> float:
        """The number."""
        _check_written(self, value, param, ctx)
        number = super().convert(value, param, ctx)
        if not math.isfinite(number):
            self.fail(f"{value} is not in the range {self._describe_range()}.", param, ctx)
        return number


class ContactRange(FiniteRange):
    """How far from a handle fingers may be [m], with why no farther."""

    def convert(self, value: float, param: click.Parameter | None, ctx: click.Context | None) -> float:
        """The number."""
        try:
            return super().convert(value, param, ctx)
        except click.BadParameter as error:
            self.fail(f"{error.message.removesuffix('.')}: {NOT_HELD}.", param, ctx)


def _check_written(
    kind: click.ParamType, value: object, param: click.Parameter | None, ctx: click.Context | None
) -> None:
    try:
        check_written(str(value))
    except ValueError as error:
        kind.fail(f"{error}.", param, ctx)


class OutFile(click.Path):
    """A file that can be written in the end: its folder is there and takes files, and its suffix is known.

    What is asked for may take minutes, so this is looked at before.
    """

    def __init__(self, *suffixes: str, dash: bool = False) -> None:
        super().__init__(dir_okay=False, writable=True, path_type=Path, allow_dash=dash)
        self.suffixes, self.dash = suffixes, dash

    def convert(
        self, value: str | os.PathLike[str], param: click.Parameter | None, ctx: click.Context | None
    ) -> Path:
        """The path."""
        path = Path(os.fsdecode(super().convert(value, param, ctx)))
        if self.dash and path == Path("-"):
            return path
        if self.suffixes and path.suffix not in self.suffixes:
            self.fail(f"a file '{path.name}'; allowed: {', '.join(self.suffixes)}", param, ctx)
        if not path.parent.is_dir():
            self.fail(f"{path}: there is no folder '{path.parent}'", param, ctx)
        check_file(path)
        return path


class OutFolder(click.Path):
    """A folder for files that are written in the end: it is there, or can be made then."""

    def __init__(self) -> None:
        super().__init__(file_okay=False, path_type=Path)

    def convert(
        self, value: str | os.PathLike[str], param: click.Parameter | None, ctx: click.Context | None
    ) -> Path:
        """The path."""
        path = Path(os.fsdecode(super().convert(value, param, ctx)))
        check_folder(path)
        return path


MOTION_FILE = OutFile(".npz", ".json", ".csv")
BODY_MOTION_FILE = OutFile(".npz", ".json", ".csv", ".mcap")

kitchen_argument = click.argument("kitchen", type=KITCHEN)
kitchens_option = click.option(
    "--kitchens", default="a,b", show_default=True, help="Bundled kitchens or paths, comma-separated."
)
robots_option = click.option(
    "--robots",
    default="pr2,tiago_dual,stretch",
    show_default=True,
    help="Bundled robots or paths, comma-separated.",
)
verb_option = click.option(
    "--task",
    "verb",
    type=click.Choice(["open", "close"]),
    default="open",
    show_default=True,
    help="What is to be done with each container.",
)
json_flag = click.option("--json", "as_json", is_flag=True, help="Print JSON.")
csv_flag = click.option(
    "--csv",
    is_flag=True,
    expose_value=False,
    callback=lambda context, _, asked: context.meta.update({CSV: asked}),
    help="Print CSV.",
)


def _once(ctx: click.Context, param: click.Parameter, texts: tuple[str, ...]) -> tuple[str, ...]:
    """The texts, no two of them about the same joint: the last would win, without a word."""
    named = Counter(text.partition("=")[0].strip() for text in texts)
    for name, times in named.items():
        if times > 1:
            raise click.BadParameter(f"{name} is given {times} times; allowed: one value of it", ctx, param)
    return texts


def state_option(
    more: str = "", *, without: str = "everything is closed"
) -> Callable[[Decorated], Decorated]:
    """`--state`, which says what else it takes here, and what holds where it is not given."""
    return click.option(
        "--state",
        "states",
        type=STATE,
        multiple=True,
        callback=_once,
        metavar="JOINT=VALUE",
        help="Start state: a joint or container at a position [rad or m], open or closed; all=open, "
        f"all=closed, all=half-open:SEED{more}. Repeatable. Without it {without}.",
    )


states_option = state_option()
drive_option = click.option(
    "--drive",
    type=click.Choice(["omni", "differential", "fixed"]),
    help="How the base moves; without it, as the robot's hardware does. omni is the paper's set-up.",
)
budget_option = click.option(
    "--budget",
    type=FiniteRange(min=0, min_open=True),
    default=20.0,
    show_default=True,
    help="Seconds of CPU that the search for each container may take before it gives up; a proof that is "
    "looked for then takes its own.",
)
any_start_option = click.option(
    "--any-start", is_flag=True, help="A robot's motion may begin anywhere, in any posture."
)
contact_option = click.option(
    "--contact-tolerance",
    "contact",
    type=ContactRange(min=0, max=MOST_CONTACT),
    metavar="M",
    help=f"How far a finger may be from the handle that it holds; without it {MOST_CONTACT:g}, the most.",
)
base_option = click.option(
    "--base",
    metavar="X,Y,YAW",
    help="Start pose of the base [m, m, rad]; without it the kitchen's, turned to the handle.",
)
FRICTION = FiniteRange(min=LEAST_FRICTION, max=MOST_FRICTION)
FRICTION_HELP = "Coefficient with which fingers rub on handles: holds that need more are refused."
friction_option = click.option(
    "--friction",
    type=FRICTION,
    metavar="MU",
    help=f"{FRICTION_HELP} Without it the verdict says what its holds need.",
)
seed_option = click.option(
    "--seed", type=WholeRange(0, 2**63 - 1), default=0, show_default=True, help="Seed of the search."
)
jobs_option = click.option(
    "--jobs",
    type=WholeRange(min=1),
    default=os.cpu_count() or 1,
    show_default="all cores",
    help="Worker processes.",
)
save_option = click.option(
    "--save",
    "--store",
    "save",
    metavar="STORE",
    help="Keep verdicts as triples: FILE.trig, FILE.nq, a directory, http://HOST of an Oxigraph, or "
    "http://HOST/QUERY,http://HOST/UPDATE of any SPARQL server.",
)
tee_option = click.option(
    "--tee",
    type=click.Choice(["d_artic", "d_artic_dyn"], case_sensitive=False),
    default="d_artic",
    show_default=True,
    help="The class that verdicts are relative to: kinematics alone, or with forces that push back.",
)
forces_option = click.option(
    "--forces",
    type=click.Path(exists=True, dir_okay=False, path_type=Path),
    metavar="FILE.ttl",
    help="What pushes back in the kitchen, for d_artic_dyn; without it, what is bundled.",
)
handle_force_option = click.option(
    "--handle-force",
    type=FiniteRange(min=0, min_open=True),
    metavar="NEWTON",
    help="Allowed at every handle, for d_artic_dyn; without it, what the force data say.",
)
annotation_option = click.option(
    "--annotation",
    type=click.Path(exists=True, dir_okay=False),
    metavar="FILE.ttl",
    help="Annotation of the robot, or of the kitchen, whichever it describes; without it, the .ttl beside "
    "the model or a bundled one that fits.",
)
