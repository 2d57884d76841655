"""Cells of the matrix: how the case of a robot and a container stands, by the verdicts that are kept."""

import asyncio
import re
from collections import Counter, defaultdict
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import cache
from typing import Final

from predicates.record.inputs import START_INPUT, TURNED, UNKNOWN_INPUT, state_hash
from predicates.scope import tee_class_hash, verb_iri
from sdt_kg.iri import Iri, local_name
from sdt_kg.scope import TEE_CLASSES
from services.http.api.read import SPELLED
from services.http.pages.asking import Asking, Wish
from services.http.pages.feasibility.asked import Asked
from services.http.pages.kinds import Standing, standings
from services.http.pages.stored import rows
from services.http.pages.view import Json
from services.http.world import World
from services.policy import told_friction
from services.versions import ORACLES, outdated

COMPARED: Final = (
    "physics", "embodiment", "embodiment.tolerances", "embodiment.margins",
    "embodiment.grasp set", "embodiment.seed",
)  # fmt: skip
"""Inputs which all cells should share; where one differs, its cell says so."""


@dataclass(frozen=True, slots=True)
class Found:
    """A verdict about one cell.

    Attributes:
        inputs: Name → value.
    """

    iri: Iri
    robot: Iri
    container: Iri
    drive: str
    outcome: str
    kinds: str
    proved: bool
    reasons: str
    inputs: dict[str, str]

    @property
    def tee(self) -> str | None:
        """Name of the class D that it is relative to; None for another version of one."""
        return _classes().get(self.inputs.get("tee_class", ""))

    @property
    def outdated(self) -> tuple[str, ...]:
        """What judged in another version than judges here; empty if it still answers."""
        return outdated(self.inputs)

    @property
    def friction(self) -> float | None:
        """Coefficient of friction [1] beyond which holds were refused; None: none were."""
        return told_friction(self.inputs.get("embodiment.tolerances", ""))

    @property
    def rank(self) -> tuple[bool, list[list[int]], int, float]:
        """Which a cell shows: what still answers, of the newest version what claims most, the longest."""
        versions = [list(map(int, re.findall(r"\d+", self.inputs.get(name, "")))) for name in ORACLES]
        claims = {"Certified": 3, "Abstained": 1}.get(self.outcome, 2 if self.proved else 0)
        budget = self.inputs.get("embodiment.budget", "0 s").removesuffix(" s")
        return not self.outdated, versions, claims, float(budget)


@dataclass(frozen=True, slots=True)
class Kept:
    """Verdicts about the cells of a matrix, and what is not among them.

    Attributes:
        shown: About the models that are served, with the drive and friction that are asked about.
        other_drives: Drive → how many more there are that differ in it.
        other_frictions: Friction, empty where none was asked for → how many more there are that differ in it.
        other_classes: Class → how many more there are that are relative to it.
        stale: How many there are about models or classes of these names that were different.
    """

    shown: list[Found]
    other_drives: dict[str, int]
    other_frictions: dict[str, int]
    other_classes: dict[str, int]
    stale: int


@cache
def _classes() -> dict[str, str]:
    """Input that says a class → its name."""
    return {tee_class_hash(each): each.name for each in TEE_CLASSES}


def _in_order(reasons: str) -> str:
    """The texts of diagnoses, in the order in which the verdict has them."""
    told = [each.partition(" ") for each in reasons.split("\x1e") if each]
    # IRIs of one verdict's diagnoses differ in their number at the end alone.
    return "\n".join(text for _, _, text in sorted(told, key=lambda each: (len(each[0]), each[0])))


async def kept_verdicts(world: World, asked: Asked) -> Kept:
    """Verdicts about the cells, and what else there is."""
    state = ("text", state_hash(asked.twin.state))
    verdicts, inputs, _ = await asyncio.gather(
        rows(world, "matrix", state=state, task=("iri", verb_iri(asked.verb))),
        rows(world, "matrix_inputs", state=state),
        asyncio.to_thread(lambda: asked.kitchen.models),
    )
    used: dict[Iri, dict[str, str]] = defaultdict(dict)
    for row in inputs:
        used[row["verdict"]][row["name"]] = row["value"]
    found = [
        Found(
            row["verdict"],
            row["robot"],
            row["container"],
            row["drive"],
            local_name(row["outcome"]),
            row.get("kinds", ""),
            row.get("proved") == "true",
            _in_order(row.get("reasons", "")),
            used[row["verdict"]],
        )
        for row in verdicts
    ]
    about = [each for each in found if _is_about(each, asked)]
    current = [each for each in about if _is_current(each, asked) and each.tee is not None]
    ours = [each for each in current if each.tee == asked.tee.name]
    driven = [each for each in ours if asked.drive_of(each.robot) in {None, each.drive}]
    shown = [each for each in driven if each.friction == asked.friction]
    drives = Counter(each.drive for each in ours) - Counter(each.drive for each in driven)
    others = sorted(each.friction or 0.0 for each in driven if each.friction != asked.friction)
    frictions = Counter(repr(each) if each else "" for each in others)
    classes = Counter(str(each.tee) for each in current if each.tee != asked.tee.name)
    told = dict(sorted(drives.items())), dict(frictions), dict(sorted(classes.items()))
    return Kept(shown, *told, len(about) - len(current))


def _is_about(found: Found, asked: Asked) -> bool:
    """Whether a motion was to be found, in this kitchen, from its start."""
    given = {found.inputs.get(name) for name in ("motion", "body_motion")} != {UNKNOWN_INPUT}
    environment = found.inputs.get("environment", "").partition(" ")[0]
    if given or environment != asked.twin.environment:
        return False
    return found.inputs.get(START_INPUT, TURNED).endswith(TURNED)


def _is_current(found: Found, asked: Asked) -> bool:
    """Whether it is about the models as they are served; the robot may be one that is not."""
    return asked.kitchen.is_subject(
        found.inputs.get("environment", ""), found.inputs.get("robot", found.robot)
    )


def _chosen(found: Iterable[Found]) -> dict[tuple[Iri, Iri], list[Found]]:
    """Robot and container → its verdicts, the one to be shown first."""
    groups: dict[tuple[Iri, Iri], list[Found]] = defaultdict(list)
    for each in sorted(found, key=lambda each: (each.rank, each.iri), reverse=True):
        groups[each.robot, each.container].append(each)
    return groups


def cells_of(asked: Asked, robots: Iterable[Iri], found: list[Found], asking: Asking) -> Iterator[Json]:
    """A row for each container and robot."""
    chosen, common = _chosen(found), common_settings(found)
    for container in asked.twin.containers():
        for robot in robots:
            name = local_name(robot)
            cell: Json = {
                "kitchen": asked.kitchen.name,
                "robot": name,
                "container": container.name,
                "container_kind": container.kind,
                "task": asked.verb.value,
                "drive": asked.drive_of(robot),
                "friction": asked.friction,
            }
            verdicts = chosen.get((robot, container.iri), [])
            if verdicts and not verdicts[0].outdated:
                yield cell | _judged(verdicts, common)
            else:
                yield cell | _unjudged(asked.wish(name, container.name), asking, verdicts)


def _judged(verdicts: list[Found], common: dict[str, str]) -> Json:
    first = verdicts[0]
    stand = standings(first.outcome, first.kinds)
    differs = [name for name, value in common.items() if first.inputs.get(name, value) != value]
    return {
        "drive": first.drive,
        "standing": stand[0].value.key if stand else Standing.NO_VERDICT.value.key,
        "was": None,
        "kinds": [each.value.key for each in stand if each is not Standing.CERTIFIED],
        "proved": first.proved if first.outcome == "NotCertified" else None,
        "reason": first.reasons or None,
        "others": len(verdicts) - 1,
        # Both cannot be right: whoever sees it has to look at their versions.
        "disagree": any(each.outcome == "Certified" for each in verdicts)
        and any(each.proved for each in verdicts),
        "differs": [name.removeprefix("embodiment.") for name in differs],
        "verdict": first.iri,
    }


def _unjudged(wish: Wish | None, asking: Asking, verdicts: list[Found]) -> Json:
    """How a case stands that no verdict answers, at most outdated ones; without a wish it cannot be asked."""
    standing = Standing.NOT_JUDGED if wish is None else asking.standing(wish)
    if verdicts and standing is Standing.NOT_JUDGED:
        standing = Standing.OUTDATED
    return {
        "standing": standing.value.key,
        "was": SPELLED[verdicts[0].outcome] if standing is Standing.OUTDATED else None,
        "kinds": [],
        "proved": None,
        "reason": None if wish is None else asking.refusal(wish),
        "others": max(len(verdicts) - 1, 0),
        "disagree": False,
        "differs": [],
        "verdict": verdicts[0].iri if standing is Standing.OUTDATED else None,
    }


def unlike(differs: Iterable[str]) -> str:
    """How a verdict was judged otherwise than most of a matrix, in words; empty if it was not."""
    others = list(differs)
    settings = [name for name in others if name not in ORACLES]
    parts = ["by another version of sdt"] if len(settings) < len(others) else []
    parts += [f"with other {' and '.join(settings)}"] if settings else []
    return f"judged {', '.join(parts)} than most here" if parts else ""


def common_settings(found: list[Found]) -> dict[str, str]:
    """What most cells share of the inputs that do not belong to their case."""
    common: dict[str, str] = {}
    firsts = [each[0] for each in _chosen(found).values() if not each[0].outdated]
    for name in COMPARED:
        counted = Counter(each.inputs[name] for each in firsts if name in each.inputs)
        if counted:
            common[name] = counted.most_common(1)[0][0]
    return common
