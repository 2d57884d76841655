"""What a link says of a case is the case."""

from services.requests import parse_base
from services.viewer.choice import Choice, wanted


def test_a_link_says_to_the_last_digit_where_base_and_doors_are() -> None:
    base, opened = (1 / 3, -12.3456789, 1e-7), {"left door": 0.1 + 0.2, "drawer": 0.25}
    choice = Choice("b", "pr2", container="left door", base=base, opened=opened)
    said = wanted(choice.link().replace("?", "/").replace("&", ";"))
    assert parse_base(said["base"]) == base
    assert said["state"].split(",") == list(choice.place().states)
    assert (said["task"], said["tee"]) == ("open:left door", "D_artic")
