"""Co-design: which robot covers most of a kitchen, which robots together, and which few edits the rest needs.

Covers are greedy: each step takes what is certified for most of what is left. Greedy covers are not
always the smallest; each number is of certified verdicts alone, so all of them are lower bounds.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial

from sdt_kg.errors import InputError
from services.app import load
from services.codesign.asked import Asked
from services.codesign.entries import Entry, Found, Grid
from services.codesign.grid import check_edits, run
from services.codesign.judge import Judge
from services.codesign.report import why
from services.codesign.smallest.families import AND, made_at_once
from services.codesign.smallest.sought import Question
from services.codesign.smallest.turning import turned
from services.whatif import World, changed

MOST_EDITS = 5
"""[1] Steps that a plan has at most."""
FOR_CANDIDATE = 5.0
"""[s] Of search for each container in a world that might be chosen."""
OF_THE_ROOM = ("handle", "furniture", "clear", "move")
"""Kinds of edits that change the kitchen and leave the robot as it is: what a plan consists of."""

Founds = dict[str, Found]


@dataclass(frozen=True, slots=True)
class Cover:
    """What one robot does in one kitchen as it is.

    Attributes:
        certified: Names of containers.
        missing: Name and first reason of each other.
    """

    kitchen: str
    robot: str
    certified: tuple[str, ...]
    missing: tuple[tuple[str, str], ...]

    @property
    def of(self) -> int:
        """[1] Containers of the kitchen."""
        return len(self.certified) + len(self.missing)


@dataclass(frozen=True, slots=True)
class Step:
    """One more robot, or one more edit.

    Attributes:
        what: Name of the robot, or the edit; `A & B` for two that are made at once.
        gained: Containers that are certified then and were not before.
        lost: The other way round.
        covered: How many are certified from then on.
    """

    what: str
    gained: tuple[str, ...]
    lost: tuple[str, ...]
    covered: int


@dataclass(frozen=True, slots=True)
class Plan:
    """Edits of a kitchen, one after the other in the same world, for one robot.

    Attributes:
        steps: In the order in which greed took them; everything was judged in the world of all so far.
        missing: Name and first reason of what is still not certified.
        candidates: Edits that were looked at.
        even: Those that gain something in the world of all steps, and lose as much or more.
    """

    kitchen: str
    robot: str
    of: int
    steps: tuple[Step, ...]
    missing: tuple[tuple[str, str], ...]
    candidates: tuple[str, ...]
    even: tuple[Step, ...] = ()


@dataclass(frozen=True, slots=True)
class Design:
    """Everything that `sdt codesign` says.

    Attributes:
        covers: For each kitchen the robots that cover most first.
        together: Kitchen → robots in the order in which greed takes them.
        plans: For each kitchen, for the robot that covers most.
        seconds: Wall time of the verdicts as things are [s].
    """

    covers: tuple[Cover, ...]
    together: tuple[tuple[str, tuple[Step, ...]], ...]
    plans: tuple[Plan, ...]
    seconds: float


def designed(  # noqa: PLR0913, PLR0917 - what is asked, and how long it may take
    asked: Asked,
    jobs: int,
    edits: Sequence[str] = (),
    within: float = 30.0,
    plan: bool = True,
    report: Callable[[Entry], None] = lambda entry: None,
) -> Design:
    """Covers of all kitchens by all robots, and edits for what the best robot of each does not do.

    Args:
        asked: Kitchens, robots, verb and policy; its worlds are not looked at.
        jobs: Processes.
        edits: Those that a plan may take; none: whatever turns a refusal, looked for.
        within: Seconds of CPU of each process for each refusal, where edits are looked for.
        plan: Whether to plan edits at all.
        report: Called with each entry as things are.

    Raises:
        InputError: A kitchen, robot or state that is not there; an edit that can be made nowhere.
    """
    check_edits(replace(asked, worlds=tuple(tuple(each.split(AND)) for each in edits)))
    grid = run(replace(asked, worlds=()), jobs, report)
    covers = covers_of(grid)
    together = tuple((kitchen, together_in(kitchen, covers)) for kitchen in asked.kitchens)
    plans: list[Plan] = []
    for kitchen in asked.kitchens if plan else ():
        best = next(each for each in covers if each.kitchen == kitchen)
        founds = {
            each.container: each.found
            for each in grid.entries
            if (each.kitchen, each.robot) == (kitchen, best.robot)
        }
        candidates = edits or _candidates(asked, best, within, jobs)
        plans.append(_planned(asked, best, founds, tuple(candidates)))
    return Design(tuple(covers), together, tuple(plans), grid.seconds)


def covers_of(grid: Grid) -> list[Cover]:
    """What each robot does in each kitchen as it is, in each kitchen the robot that does most first."""
    entries: dict[tuple[str, str], list[Entry]] = {}
    for each in grid.actual().values():
        entries.setdefault((each.kitchen, each.robot), []).append(each)
    covers = [
        Cover(
            kitchen,
            robot,
            tuple(each.container for each in own if each.found.is_certified),
            tuple((each.container, why(each)) for each in own if not each.found.is_certified),
        )
        for (kitchen, robot), own in entries.items()
    ]
    kitchens = list(dict.fromkeys(each.kitchen for each in covers))
    return sorted(covers, key=lambda each: (kitchens.index(each.kitchen), -len(each.certified), each.robot))


def together_in(kitchen: str, covers: Sequence[Cover]) -> tuple[Step, ...]:
    """Robots of which each does most of what those before it do not."""
    left = {each.robot: each for each in covers if each.kitchen == kitchen}
    done: set[str] = set()
    steps: list[Step] = []
    while left:
        best = min(left.values(), key=lambda each: (-len(set(each.certified) - done), each.robot))
        gained = [each for each in best.certified if each not in done]
        if not gained:
            break
        done.update(gained)
        steps.append(Step(best.robot, tuple(gained), (), len(done)))
        del left[best.robot]
    return tuple(steps)


def _candidates(asked: Asked, cover: Cover, within: float, jobs: int) -> list[str]:
    """Edits of the kitchen that turn one of its refusals, the smallest of each family."""
    found: list[str] = []
    for container, _ in cover.missing:
        task = f"{asked.verb}:{container}"
        question = Question(cover.kitchen, cover.robot, task, asked.states, asked.policy, asked.relative)
        for each in turned(question, within, jobs).sought:
            edit = "" if each.turn is None else each.turn.edit
            if edit and all(part.partition(":")[0] in OF_THE_ROOM for part in edit.split(AND)):
                found.append(edit)
    return list(dict.fromkeys(found))


def _planned(asked: Asked, cover: Cover, founds: Founds, candidates: tuple[str, ...]) -> Plan:
    """Edits, greedily, each judged in the world of all before it."""
    policy = replace(asked.policy, budget=min(asked.policy.budget, FOR_CANDIDATE))
    service = load(cover.kitchen, [cover.robot], state=asked.states, policy=policy)
    world = World(asked.relative.of(service), cover.robot)
    steps, even, left = list[Step](), list[Step](), list(candidates)
    while left and len(steps) < MOST_EDITS and not all(each.is_certified for each in founds.values()):
        step, even = _best_step(world, asked.verb, founds, left)
        if step is None:
            break
        edit, world, after = step
        left.remove(edit)
        steps.append(_step(edit, founds, after))
        founds, even = after, []
    missing = tuple((name, _reason(each)) for name, each in founds.items() if not each.is_certified)
    return Plan(cover.kitchen, cover.robot, len(founds), tuple(steps), missing, candidates, tuple(even))


def _best_step(
    world: World, verb: str, founds: Founds, candidates: Sequence[str]
) -> tuple[tuple[str, World, Founds] | None, list[Step]]:
    """The edit after which most is certified; None if none gains more than it loses, and those that gain."""
    now, best, even = _count(founds), None, list[Step]()
    for edit in candidates:
        try:
            after = changed(world, made_at_once(edit))
        except InputError:  # an edit before it has made it impossible: it is no candidate here
            continue
        judge = Judge(world, after, {})
        judged = partial(_judged, judge, verb)
        open_now = [name for name, each in founds.items() if not each.is_certified]
        gained = {name: judged(name, founds[name]) for name in open_now}
        least = now if best is None else _count(best[2])
        if now + _count(gained) <= least:
            continue
        whole = {name: gained[name] if name in gained else judged(name, founds[name]) for name in founds}
        if _count(whole) > least:
            best = (edit, after, whole)
        else:
            even.append(_step(edit, founds, whole))
    return best, even


def _judged(judge: Judge, verb: str, container: str, base: Found) -> Found:
    return judge.judged(f"{verb}:{container}", base)


def _step(edit: str, before: Founds, after: Founds) -> Step:
    gained = tuple(name for name in after if after[name].is_certified > before[name].is_certified)
    lost = tuple(name for name in after if after[name].is_certified < before[name].is_certified)
    return Step(edit, gained, lost, _count(after))


def _count(founds: Founds) -> int:
    return sum(each.is_certified for each in founds.values())


def _reason(found: Found) -> str:
    return str(found.diagnoses[0]["reason"]) if found.diagnoses else ""


def to_json(design: Design) -> dict[str, object]:
    """The object that `sdt codesign --json` prints."""
    return {
        "covers": [
            {
                "kitchen": each.kitchen,
                "robot": each.robot,
                "certified": len(each.certified),
                "of": each.of,
                "containers": list(each.certified),
                "missing": [{"container": name, "why": reason} for name, reason in each.missing],
            }
            for each in design.covers
        ],
        "together": {kitchen: list(map(_step_json, steps)) for kitchen, steps in design.together},
        "plans": [
            {
                "kitchen": each.kitchen,
                "robot": each.robot,
                "of": each.of,
                "steps": list(map(_step_json, each.steps)),
                "missing": [{"container": name, "why": reason} for name, reason in each.missing],
                "candidates": list(each.candidates),
                "even": list(map(_step_json, each.even)),
            }
            for each in design.plans
        ],
        "method": "greedy over certified verdicts: no smaller cover is excluded",
        "seconds": round(design.seconds, 3),
    }


def _step_json(step: Step) -> dict[str, object]:
    return {
        "what": step.what,
        "gained": list(step.gained),
        "lost": list(step.lost),
        "covered": step.covered,
    }
