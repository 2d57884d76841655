"""Edits of different things commute, and an edit that is undone leaves the world, and its question's IRI."""

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from predicates.record.inputs import inputs_of, verdict_iri
from services.app import Service
from services.whatif import World, changed, parse_change
from tests.services.dynamics.forced import FOLDING
from tests.small import small_twin

KINEMATIC = Service(small_twin("a", ("pr2",)))
WORLDS = {
    "D_artic": World(KINEMATIC, "pr2"),
    "D_artic_dyn": World(KINEMATIC.with_forces(FOLDING), "pr2"),
}
ASKED = "open:side_door"
CONTAINERS = ("low_drawer", "high_drawer", "side_door")
OBSTACLES = ("crate", "stool")

Undone = tuple[str, str]
"""An edit, and the one that undoes it."""


def numbers(low: float, high: float) -> st.SearchStrategy[float]:
    return st.floats(low, high).map(lambda number: round(number, 3))


def moved(name: str) -> st.SearchStrategy[Undone]:
    return numbers(0.05, 0.4).map(lambda at: (f"move:{name}={at}", f"move:{name}=0"))


def slowed(name: str) -> st.SearchStrategy[Undone]:
    joint, was = f"{name}_joint.velocityLimit", 1 if name == "side_door" else 0.5
    return numbers(0.1, 0.4).map(lambda to: (f"set:{joint}={to}", f"set:{joint}={was}"))


def posed(name: str) -> st.SearchStrategy[Undone]:
    joint, was = f"{name}_handle_joint", "-0.05,0.45,0" if name == "side_door" else "-0.05,0,0"
    return numbers(0.05, 0.2).map(lambda z: (f"pose:{joint}=-0.05,0,{z}", f"pose:{joint}={was}"))


def jammed(name: str) -> st.SearchStrategy[Undone]:
    was = 1 if name == "side_door" else 0.5
    return st.just((f"jam:{name}", f"set:{name}_joint.velocityLimit={was}"))


def placed(name: str) -> st.SearchStrategy[Undone]:
    sizes = st.tuples(*[numbers(0.1, 1)] * 3, *[numbers(-3, 3)] * 2)
    return sizes.map(lambda n: ("box:{}={},{},{}@{},{},0.5".format(name, *n), f"without:{name}"))


def of_container(name: str) -> st.SearchStrategy[Undone]:
    return st.one_of(moved(name), slowed(name), posed(name), jammed(name))


THINGS = {name: of_container(name) for name in CONTAINERS} | {name: placed(name) for name in OBSTACLES}
"""Name of a thing → edits of it, each with what undoes it."""
OF_THINGS = st.lists(st.sampled_from(sorted(THINGS)), min_size=2, max_size=3, unique=True).flatmap(
    lambda names: st.tuples(*(THINGS[name] for name in names))
)
LAWS = settings(max_examples=6, derandomize=True, suppress_health_check=[HealthCheck.too_slow])


def iri_after(tee: str, *texts: str) -> str:
    """Of the question in the class's world after edits."""
    world = changed(WORLDS[tee], tuple(map(parse_change, texts)))
    service = world.service
    case = service.case(ASKED, world.robot_iri)
    return verdict_iri(inputs_of(case, service.physics, service.embodiment))


AS_IT_IS = {tee: iri_after(tee) for tee in WORLDS}


def test_the_classes_ask_different_questions() -> None:
    assert AS_IT_IS["D_artic"] != AS_IT_IS["D_artic_dyn"]


@pytest.mark.parametrize("tee", WORLDS)
@LAWS
@given(edits=OF_THINGS, chance=st.randoms(use_true_random=False))
def test_edits_of_different_things_commute(tee: str, edits: tuple[Undone, ...], chance) -> None:
    texts = [edit for edit, _ in edits]
    shuffled = [*texts]
    chance.shuffle(shuffled)
    after = iri_after(tee, *texts)
    assert after == iri_after(tee, *shuffled) == iri_after(tee, *texts[::-1]) != AS_IT_IS[tee]


@pytest.mark.parametrize("tee", WORLDS)
@LAWS
@given(edits=OF_THINGS)
def test_an_edit_that_is_undone_leaves_the_question_as_it_was(tee: str, edits: tuple[Undone, ...]) -> None:
    (first, undone), *others = edits
    rest = [edit for edit, _ in others]
    assert iri_after(tee, first, undone) == AS_IT_IS[tee]
    assert iri_after(tee, first, *rest, undone) == iri_after(tee, *rest)
    assert iri_after(tee, first) != AS_IT_IS[tee]
