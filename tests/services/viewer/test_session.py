"""What people at the page do, and what they are shown: in the page's own protocol, without a browser."""

from collections.abc import Iterator
from urllib.parse import quote

import pytest
from viser import _messages as wire

from services.viewer.page import Page
from services.viewer.running import Offer, running
from services.viewer.scene.stage import LABEL
from tests.services.viewer.visitor import Visitor

DRAWER = "sink_area_left_middle_drawer_main"

DOOR = """<robot name="r"><link name="wall"/>
  <link name="door"><collision><geometry><box size="0.5 0.02 0.5"/></geometry></collision></link>
  <link name="door_handle"><collision><geometry><box size="0.02 0.02 0.1"/></geometry></collision></link>
  <joint name="door_joint" type="revolute"><parent link="wall"/><child link="door"/>
    <origin xyz="1 0 1"/><axis xyz="0 0 1"/><limit lower="0" upper="1.5" effort="1" velocity="1"/></joint>
  <joint name="door_handle_joint" type="fixed"><parent link="door"/><child link="door_handle"/>
    <origin xyz="0.2 -0.05 0"/></joint>
</robot>"""


@pytest.fixture(scope="module")
def page() -> Iterator[Page]:
    with running("127.0.0.1:0", Offer(("b", "a"), ("pr2", "stretch"))) as one:
        yield one


def red(visitor: Visitor) -> list[object]:
    """Colours of what stands out in the ghost."""
    painted = [
        each for name, each in list(visitor.nodes.items()) if name.startswith("/ghost") and "/p" in name
    ]
    return [each["props"]["color"] for each in painted]


@pytest.fixture
def visitor(page: Page) -> Iterator[Visitor]:
    with Visitor(page.port, f"/case/kitchen=b;robot=pr2;task=open:{DRAWER}") as one:
        one.waits_for("Ready.")
        yield one


@pytest.mark.oracle
def test_a_drawer_is_certified_and_its_motion_plays(visitor: Visitor) -> None:
    assert "Choose kitchen, robot and container" in visitor.reads()
    visitor.until(lambda: "/paths" in visitor.nodes, "handle paths")
    visitor.clicks("Check")
    said = visitor.waits_for("Judged in")
    assert visitor.outcome() == "CERTIFIED"
    assert f"Can pr2 open {DRAWER} in kitchen b?" in said
    assert "drive → approach → grasp → follow" in said.replace("*", "")
    assert visitor.value("Look at") == "the whole motion"
    start = visitor.nodes["/robot"].get("position")
    visitor.sets("Speed", "8x")
    visitor.until(lambda: visitor.value("Time [s]") > 10, "it plays by itself")
    visitor.until(lambda: visitor.nodes["/robot"].get("position") != start, "the robot has moved")
    looks = visitor.control("Look at")[1]["options"]
    pair = next(each for each in looks if "handle" in each)
    visitor.sets("Look at", pair)
    visitor.until(lambda: "/marks/0/line" in visitor.nodes, "a line at the closest pair")
    visitor.clicks("Save the verdict (.trig)")
    visitor.until(lambda: bool(visitor.files), "a file")
    assert visitor.files[0]["filename"].endswith(".trig")


@pytest.mark.oracle
def test_a_start_inside_furniture_is_refused_with_a_ghost_and_red_links(visitor: Visitor) -> None:
    visitor.sets("Base pose", "as set below")
    visitor.sets("x, y, yaw", (1.2, 0.9, 0.0))
    visitor.clicks("Check")
    said = visitor.waits_for("Judged in")
    assert visitor.outcome() == "NOT CERTIFIED"
    assert "parked at its start pose" in said
    visitor.until(lambda: red(visitor) == [[205, 28, 28]], "a red link of a ghost")
    visitor.until(lambda: visitor.nodes["/ghost"]["position"][:2] == pytest.approx((1.2, 0.9)), "it is there")
    visitor.until(lambda: "/marks/0/label" in visitor.nodes, "a line over the gap, and what it is")
    assert "/marks/0/line" in visitor.nodes
    label = visitor.nodes["/marks/0/label"]["props"]
    lines = label["text"].split("\n")
    assert len(lines) > 1, label["text"]
    assert max(map(len, lines)) <= LABEL, "it reaches under a panel beside the scene"
    assert label["anchor"] == "bottom-center"


@pytest.mark.oracle
def test_what_is_no_input_is_said_as_on_the_shell_and_the_page_lives_on(visitor: Visitor) -> None:
    visitor.opens(
        "A kitchen (.urdf)", "broken.urdf", b"<robot name='r'><link name='a'/><link name='b'/></robot>"
    )
    visitor.waits_for("2 links without parent: 'a', 'b'; allowed: one root")
    visitor.opens("A kitchen (.urdf)", "empty.urdf", b"<robot name='r'><link name='a'/></robot>")
    visitor.waits_for("has no container")
    assert visitor.value("Kitchen") == "b"
    visitor.opens("A motion", "wrong.csv", b"time,elbow\n0,0\n1,zero\n")
    visitor.waits_for("'zero' in the column elbow of line 3 is no number")
    visitor.clicks("Leave the motion")
    visitor.clicks("Check")
    visitor.until(lambda: visitor.outcome() == "CERTIFIED", "a verdict")


@pytest.mark.oracle
@pytest.mark.parametrize("own", [False, True])
def test_of_another_kitchen_no_handle_path_and_no_verdict_of_the_first_is_shown(
    visitor: Visitor, own: bool
) -> None:
    visitor.sets("Verdict follows", False)
    visitor.clicks("Check")
    visitor.until(lambda: visitor.outcome() == "CERTIFIED", "a verdict")
    visitor.until(lambda: "/paths" in visitor.nodes, "handle paths")
    if own:
        visitor.opens("A kitchen (.urdf)", "own.urdf", DOOR.encode())
        visitor.waits_for("Kitchen own.")
    else:
        visitor.sets("Kitchen", "a")
        visitor.waits_for("Something was changed since")
    assert visitor.outcome() == ""
    assert visitor.said == []


@pytest.mark.parametrize("name", ["b", "a", "pr2"])
def test_a_kitchen_that_is_called_as_one_on_offer_stands_beside_it(visitor: Visitor, name: str) -> None:
    visitor.opens("A kitchen (.urdf)", f"{name}.urdf", DOOR.encode())
    visitor.until(lambda: visitor.value("Kitchen") == f"{name}-own", "the kitchen of one's own")
    assert visitor.control("Kitchen")[1]["options"] == ["b", "a", f"{name}-own"]
    visitor.until(lambda: f"/case?kitchen={name}-own&" in visitor.reads(), "a link that names it")
    visitor.opens("A kitchen (.urdf)", f"{name}.urdf", DOOR.replace("door", "flap").encode())
    visitor.until(lambda: visitor.value("Container") == "flap", "the same, changed")
    assert visitor.control("Kitchen")[1]["options"] == ["b", "a", f"{name}-own"]
    visitor.sets("Kitchen", "b")
    visitor.until(lambda: "iai_fridge_door" in visitor.control("Container")[1]["options"], "the bundled one")


@pytest.mark.oracle
def test_two_people_do_not_share_what_they_choose_or_see(page: Page, visitor: Visitor) -> None:
    with Visitor(page.port) as other:
        other.waits_for("Ready.")
        other.sets("Kitchen", "a")
        other.until(lambda: "cabinet" in str(other.value("Container")), "a container of kitchen a")
        visitor.clicks("Check")
        visitor.until(lambda: visitor.outcome() == "CERTIFIED", "a verdict")
        assert visitor.value("Kitchen") == "b"
        assert visitor.value("Container") == DRAWER
        assert "CERTIFIED" not in other.reads()


@pytest.mark.parametrize(
    ("case", "words"),
    [
        ("kitchen=%2Fetc%2Fpasswd", "no kitchen named '/etc/passwd'"),
        ("robot=pr3", "no robot named 'pr3'; did you mean 'pr2'"),
        ("task=fly", "no task type 'fly'"),
        ("state=oven=9", "oven"),
        ("friction=much", "'much' is no coefficient of friction; allowed: 0.01 to 10"),
        ("tee=D_fluid", "no TEE class 'D_fluid'; allowed: D_artic, D_artic_dyn"),
    ],
)
def test_a_wrong_link_is_said_and_the_page_opens(page: Page, case: str, words: str) -> None:
    with Visitor(page.port, f"/case/{case}") as one:
        one.until(lambda: any(words in each for each in one.said), words)
        assert one.value("Kitchen") == "b"


def test_a_link_says_relative_to_which_class_is_asked(page: Page) -> None:
    with Visitor(page.port, f"/case/kitchen=b;robot=pr2;task=open:{DRAWER};tee=D_artic_dyn") as one:
        one.waits_for("Ready.")
        assert one.value("TEE class") == "D_artic_dyn"
        assert f"/case?kitchen=b&robot=pr2&task=open:{DRAWER}&tee=D_artic_dyn)" in one.reads()


@pytest.mark.oracle
def test_a_link_says_how_much_fingers_rub_and_the_verdict_is_about_that(page: Page) -> None:
    with Visitor(page.port, f"/case/kitchen=b;robot=pr2;task=open:{DRAWER};friction=0.3") as one:
        one.waits_for("Ready.")
        assert one.value("Friction") == 0.3
        one.clicks("Check")
        assert "holds that need friction of more than 0.3 are refused: as asked" in one.waits_for("Judged in")
        assert "&friction=0.3" in one.reads()
        one.sets("Friction", 0.0)
        one.until(lambda: "friction=" not in one.reads(), "nothing is asked of the fingers")


@pytest.mark.parametrize("name", ["<img src=x onerror=alert(1)>", "<h1>CERTIFIED</h1>", "*a*_b_ قفل"])
def test_what_a_link_or_file_is_called_is_not_read_as_html_or_markdown(page: Page, name: str) -> None:
    with Visitor(page.port, f"/case/kitchen={quote(name, safe='')}") as one:
        one.until(lambda: f"error: no kitchen named '{name}'" in " ".join(one.reads().split()), name)


def test_a_browser_cannot_open_the_tunnel(page: Page, visitor: Visitor) -> None:
    visitor.send(wire.ShareUrlRequest())
    visitor.sets("Request", "close")
    visitor.until(lambda: "close" in str(visitor.reads()), "the page goes on")
    assert page._server._share_tunnel is None


def test_a_file_whose_name_is_too_long_to_be_kept_is_named(visitor: Visitor) -> None:
    visitor.opens("A motion", f"{'m' * 300}.npz", b"")
    visitor.waits_for(f"cannot write {'m' * 300}.npz: file name too long")
