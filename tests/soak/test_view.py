"""What people at the 3D page do that takes longer: follow changes, motions of theirs; a real browser."""

import time
from base64 import b64decode
from collections.abc import Iterator
from functools import partial
from io import BytesIO
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from scipy.spatial.transform import Rotation
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys
from viser import CameraHandle

from sdt_kg.motion import BodyMotion
from services.app import load
from services.motions import write_motion
from services.viewer.running import Offer, running
from services.viewer.scene.gizmos import BOX
from tests.browser import Browser, is_local
from tests.services.viewer.person import Person
from tests.services.viewer.visitor import Visitor

STILL = 4
"""Pictures in a row, a second apart."""
COARSE, ALIKE = (
    4,
    1.0,
)  # pixels that count as one; grey levels: by 0.5 the same differs, by 2 the other shapes
DRAWER = "sink_area_left_middle_drawer_main"
NAMELESS = """
    const named = each => each.textContent.trim() || each.getAttribute('aria-label') || each.labels?.length;
    const kinds = 'button:not([aria-hidden=true]), input:not([type=file]), [role=slider]';
    const controls = document.querySelectorAll(kinds);
    return [...controls].filter(each => !named(each)).map(each => each.outerHTML.slice(0, 200));
"""
"""Controls that nobody could read out."""
SMALL = """
    const kinds = 'button:not([aria-hidden=true]), input:not([type=file]), [role=tab]';
    const controls = [...document.querySelectorAll(kinds)].filter(each => each.offsetWidth > 0);
    const small = controls.filter(each => Math.min(each.offsetWidth, each.offsetHeight) < 24);
    return small.map(each => each.outerHTML.slice(0, 200));
"""
"""Controls that are hard to hit. Arrows of numbers, hidden from readers, do nothing that typing cannot."""


@pytest.fixture(scope="module")
def port() -> Iterator[int]:
    with running("127.0.0.1:0", Offer(("b",), ("pr2", "stretch"))) as page:
        yield page.port


@pytest.fixture
def visitor(port: int) -> Iterator[Visitor]:
    with Visitor(port, f"/case/kitchen=b;robot=pr2;task=open:{DRAWER}") as one:
        one.waits_for("Ready.")
        yield one


@pytest.mark.oracle
def test_the_verdict_follows_a_change_and_says_until_then_that_it_is_old(visitor: Visitor) -> None:
    visitor.clicks("Check")
    visitor.until(lambda: visitor.outcome() == "CERTIFIED", "a verdict")
    visitor.sets("Robot", "stretch")
    visitor.waits_for("Something was changed since")
    visitor.waits_for("Can stretch open")
    assert "Something was changed since" not in visitor.reads()
    visitor.sets("Verdict follows", False)
    visitor.sets("A box stands there", True)
    visitor.waits_for("Something was changed since")
    assert visitor.nodes["/gizmo/box/body"]["props"]["dimensions"] == [0.4, 0.4, 0.9]


@pytest.mark.oracle
def test_the_verdict_follows_an_obstacle_that_is_dragged(visitor: Visitor) -> None:
    visitor.clicks("Check")
    visitor.until(lambda: visitor.outcome() == "CERTIFIED", "a verdict")
    visitor.sets("A box stands there", True)
    visitor.until(lambda: "/gizmo/box" in visitor.nodes, "a box")
    visitor.drags("/gizmo/box", 0.9, 0.89)  # where the handle goes
    visitor.until(lambda: visitor.outcome() == "NOT CERTIFIED", "the box is in the way")
    assert "obstacle" in visitor.reads()
    visitor.drags("/gizmo/box", -2.0, -2.0)
    visitor.until(lambda: visitor.outcome() == "CERTIFIED", "the box is out of the way")


@pytest.mark.oracle
def test_the_verdict_follows_a_drawer_that_is_half_open(visitor: Visitor) -> None:
    visitor.clicks("Check")
    visitor.until(lambda: visitor.outcome() == "CERTIFIED", "a verdict")
    visitor.sets("Position", 0.2)
    visitor.until(lambda: f"kitchen: {DRAWER}_joint at 0.2" in visitor.reads(), "a verdict from there")
    assert visitor.outcome() == "CERTIFIED"
    visitor.sets("Position", 0.48)
    visitor.until(lambda: visitor.outcome() == "NOT CERTIFIED", "it is open")
    assert "nothing to cause" in visitor.reads()
    visitor.clicks("Close all")
    visitor.until(lambda: visitor.outcome() == "CERTIFIED", "it is closed again")


@pytest.mark.oracle
def test_the_verdict_follows_the_base_that_is_moved(visitor: Visitor) -> None:
    visitor.clicks("Check")
    visitor.until(lambda: visitor.outcome() == "CERTIFIED", "a verdict")
    visitor.sets("Move it in the scene", True)
    visitor.until(lambda: "/gizmo/base" in visitor.nodes, "handles at the base")
    visitor.drags("/gizmo/base", 1.2, 0.9)
    visitor.until(lambda: visitor.outcome() == "NOT CERTIFIED", "the robot stands in the furniture")
    assert "parked at its start pose" in visitor.reads()
    visitor.drags("/gizmo/base", 0.1, 0.2, 0.3)
    visitor.until(lambda: visitor.outcome() == "CERTIFIED", "the robot stands free")
    assert "start of the base: x 0.1 m, y 0.2 m" in visitor.reads()


@pytest.mark.oracle
def test_a_motion_is_judged_as_it_is_and_shown_where_it_breaks_a_rule(
    visitor: Visitor, tmp_path: Path
) -> None:
    service = load("b", ["pr2"])
    (verdict,) = service.achieve(f"open:{DRAWER}")
    motion = verdict.case.body_motion
    assert isinstance(motion, BodyMotion)
    good = tmp_path / "good.npz"
    write_motion(good, motion)
    with np.load(good) as arrays:
        spoilt = {name: arrays[name] for name in arrays.files}
    elbow = list(spoilt["robot_joint_names"]).index("l_elbow_flex_joint")
    share = spoilt["times"] / spoilt["times"][-1]
    spoilt["robot_positions"][:, elbow] += 3.0 * np.sin(np.pi * share) ** 2  # beyond its upper limit of 0
    spoilt = {name: array for name, array in spoilt.items() if "velocities" not in name}
    bad = tmp_path / "bad.npz"
    np.savez(bad, **spoilt)
    visitor.opens("A motion", "good.npz", good.read_bytes())
    visitor.until(lambda: visitor.outcome() == "CERTIFIED", "a verdict about the motion")
    visitor.waits_for("motion: the robot's motion was given")
    visitor.opens("A motion", "bad.npz", bad.read_bytes())
    visitor.until(lambda: visitor.outcome() == "NOT CERTIFIED", "a verdict about the spoilt one")
    visitor.waits_for("l_elbow_flex_joint")
    visitor.until(lambda: "/ghost" in visitor.nodes, "a ghost where it breaks the rule")
    visitor.clicks("Leave the motion")
    visitor.waits_for("motion: to be found")


@pytest.mark.oracle
def test_in_a_browser_a_case_is_judged_and_nothing_leaves_the_machine(
    browser: Browser, port: int, tmp_path: Path
) -> None:
    person = Person(browser)
    browser.driver.get(f"http://127.0.0.1:{port}/case?kitchen=b&robot=pr2&task=open:{DRAWER}")
    person.waits_for("Ready.")
    person.clicks("Check")
    said = person.waits_for("Judged in")
    assert "CERTIFIED\n" in said
    for predicate in ("SatisfiesRequest", "Causes", "CanPerform"):
        assert f"{predicate}\t✓ yes" in said
    assert browser.driver.execute_script(NAMELESS) == []
    person.clicks("Files")
    large = tmp_path / "large.npz"
    with large.open("wb") as hole:
        hole.truncate(300 * 2**20)
    person.opens(0, large)
    person.waits_for("'large.npz' has 300 MB; allowed: 32 MB")
    assert browser.console_errors() == []
    asked = list(browser.requests())
    assert asked
    assert all(map(is_local, asked))
    assert not [url for url in asked if url.startswith("data:image/jpeg")], "viser's own light"


def pixel(camera: CameraHandle, canvas: dict[str, int], point: tuple[float, float, float]) -> tuple[int, int]:
    """Where in the window a point of the scene is seen."""
    w, *xyz = camera.wxyz
    seen = (
        Rotation.from_quat([*xyz, w]).inv().apply(np.array(point) - camera.position)
    )  # z is forwards, y down
    focal = canvas["height"] / 2 / np.tan(camera.fov / 2)
    x, y = focal * seen[:2] / seen[2]
    return round(canvas["x"] + canvas["width"] / 2 + x), round(canvas["y"] + canvas["height"] / 2 + y)


@pytest.mark.oracle
def test_an_obstacle_is_dragged_into_the_way_with_the_mouse(browser: Browser) -> None:
    person = Person(browser)
    with running("127.0.0.1:0", Offer(("b",), ("pr2",))) as page:
        browser.driver.get(f"{page.url}case?kitchen=b&robot=pr2&task=open:{DRAWER}")
        person.waits_for("Ready.")
        person.clicks("What if")
        person.ticks("A box stands there")
        (client,) = page._server.get_clients().values()
        box = person.browser.until(lambda: client.scene.get_handle_by_name(BOX), "a box")
        person.clicks("Ask")
        person.clicks("Check")
        person.until(lambda: "\nCERTIFIED\n" in person.reads(), "a verdict with the box aside")
        canvas = browser.driver.find_element(By.CSS_SELECTOR, "canvas[data-engine]").rect
        x, y, z = box.position
        grip, aim = (pixel(client.camera, canvas, (x, y + away, z)) for away in (0.4, 0.4 + 0.89))
        drag = ActionChains(browser.driver).w3c_actions
        drag.pointer_action.move_to_location(*grip).pointer_down()
        for share in np.linspace(0, 1, 12):
            at = np.round(np.array(grip) + share * (np.array(aim) - grip)).astype(int)
            drag.pointer_action.move_to_location(*map(int, at)).pause(0.1)
        drag.pointer_action.pointer_up()
        drag.perform()
        person.until(lambda: box.position[1] - y > 0.5, "the box is elsewhere")
        assert box.position[0] == pytest.approx(x, abs=1e-3)
        person.until(lambda: "\nNOT CERTIFIED\n" in person.reads(), "the box is in the way")
        assert browser.console_errors() == []


@pytest.mark.oracle
def test_the_page_is_readable_and_reached_by_keyboard_on_a_laptop_and_a_phone(
    browser: Browser, port: int
) -> None:
    person = Person(browser)
    browser.driver.get(f"http://127.0.0.1:{port}/case?kitchen=b&robot=pr2&task=open:{DRAWER}")
    person.waits_for("Ready.")
    assert browser.driver.title == "sdt: kitchens, robots and verdicts in 3D"
    for tab, control in (("Show", "Marks and ghost"), ("What if", "Close all"), ("Ask", "Check")):
        person.tabs_to(tab)
        person.presses(Keys.ENTER)
        person.waits_for(control)
        person.tabs_to(control)
        assert browser.weak_texts() == []
        assert browser.driver.execute_script(SMALL) == []
    person.presses(Keys.ENTER)
    person.waits_for("Judged in")
    assert browser.weak_texts() == []
    for size in ((1280, 720), (390, 844)):
        browser.resize(*size)
        person.until(partial(within, person, "Check", size), f"all of the button on {size}")
    browser.resize(1280, 720)


def within(person: Person, label: str, size: tuple[int, int]) -> bool:
    """Nothing of the button is beyond the window."""
    place = person.named(label).rect
    right, below = place["x"] + place["width"], place["y"] + place["height"]
    return 0 <= place["x"] < right <= size[0] and 0 <= place["y"] < below <= size[1]


def drawn(browser: Browser) -> str:
    """The middle of the scene."""
    area = {"x": 340, "y": 180, "width": 600, "height": 500, "scale": 1}
    return browser.driver.execute_cdp_cmd("Page.captureScreenshot", {"format": "png", "clip": area})["data"]


def unlike(one: str, other: str) -> float:
    """How much two pictures differ on average [grey levels], coarsely: a slow machine draws fewer pixels."""
    a, b = (Image.open(BytesIO(b64decode(each))).convert("L").reduce(COARSE) for each in (one, other))
    return float(np.abs(np.asarray(a, dtype=np.float64) - b).mean())


def settled(browser: Browser) -> str:
    """The middle of the scene, as soon as nothing in it changes."""
    last = [drawn(browser)]
    while len(last) < STILL:
        time.sleep(1)
        now = drawn(browser)
        last = [*last, now] if now == last[-1] else [now]
    return last[-1]


@pytest.mark.oracle
def test_bodies_look_as_the_urdf_says_where_it_has_meshes(browser: Browser, reference: Path) -> None:
    person = Person(browser)
    kitchen = str(reference / "kitchen_b_iai_kitchen" / "kitchen.urdf")
    with running("127.0.0.1:0", Offer((kitchen,), ("pr2",))) as page:
        browser.driver.get(page.url)
        person.waits_for("Ready.")
        person.clicks("Show")
        person.ticks("Handle paths")
        judged = settled(browser)

        def is_judged() -> bool:
            return unlike(drawn(browser), judged) < ALIKE

        person.ticks("Visual geometry")
        person.ticks("Collision geometry")
        person.until(lambda: not is_judged(), "what bodies look like")
        person.ticks("Visual geometry")
        person.ticks("Collision geometry")
        person.until(is_judged, "what is judged")
        assert browser.console_errors() == []
        assert browser.foreign_requests() == []
