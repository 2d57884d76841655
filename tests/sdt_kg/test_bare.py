"""The kitchen of a twin without its robots."""

from sdt_kg.load import load_twin, read_robot, with_robot


def test_the_robots_of_a_kitchen_share_it_until_it_is_edited() -> None:
    there = load_twin("b")
    joined = [with_robot(there, read_robot(name)) for name in ("stretch", "tiago_dual")]
    assert all(each.bare.entities is there.entities for each in joined)
    container = there.containers()[0]
    edited = joined[0].with_edit(container.joint, upperLimit=0.9 * container.upper)
    assert edited.bare.container(container.name).upper == 0.9 * container.upper
    assert edited.bare.robots == ()
    assert there.container(container.name).upper == container.upper
    assert joined[0].with_edit(joined[0].robots[0], baseHeight=0.1).bare.entities is there.entities
