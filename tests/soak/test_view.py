"""What people at the 3D page do that takes longer: follow changes, motions of theirs; a real browser."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from selenium.webdriver.common.by import By
from viser import _messages as wire

from sdt_kg.motion import BodyMotion
from services.app import load
from services.motions import write_motion
from services.viewer.running import Offer, running
from tests.browser import Browser
from tests.services.viewer.person import Person
from tests.services.viewer.visitor import Visitor

DRAWER = "sink_area_left_middle_drawer_main"


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
    visitor.waits_for("CERTIFIED")
    visitor.sets("Robot", "stretch")
    visitor.waits_for("Something was changed since")
    assert "Can stretch open" in visitor.waits_for("Can stretch open")
    assert "Something was changed since" not in visitor.reads()
    visitor.sets("Verdict follows", False)
    visitor.sets("A box stands there", True)
    visitor.waits_for("Something was changed since")
    x, y, _ = visitor.nodes["/gizmo/box"]["position"]
    visitor.send(wire.TransformControlsUpdateMessage("/gizmo/box", (1, 0, 0, 0), (x + 5.0, y, 0.0), "0"))
    assert visitor.nodes["/gizmo/box/body"]["props"]["dimensions"] == [0.4, 0.4, 0.9]


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
    assert "motion: the robot's motion was given" in visitor.waits_for("CERTIFIED")
    visitor.opens("A motion", "bad.npz", bad.read_bytes())
    said = visitor.waits_for("NOT CERTIFIED")
    assert "l_elbow_flex_joint" in said
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
    person.clicks("Files")
    person.until(
        lambda: len(browser.driver.find_elements(By.CSS_SELECTOR, "input[type=file]")) == 2, "buttons"
    )
    large = tmp_path / "large.npz"
    with large.open("wb") as hole:
        hole.truncate(300 * 2**20)
    person.opens(0, large)
    person.waits_for("'large.npz' has 300 MB; allowed: 32 MB")
    assert browser.console_errors() == []
    assert browser.foreign_requests() == []
