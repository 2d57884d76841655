"""The report in a real browser: it asks for nothing, says no error, draws and plays."""

import numpy as np
import pytest
from selenium.webdriver.common.keys import Keys

from services.physics.model import Scene
from services.reports.studies.judged import judged
from tests.browser import Browser
from tests.services.reports.conftest import DRAWER, Written

READY = "return Boolean(document.querySelector('.sdt-view') && document.querySelector('.sdt-view').sdtView)"
OPAQUE = """
const gl = document.querySelector('.sdt-view canvas').getContext('webgl2');
return gl.getContextAttributes().alpha === false
"""
COLORS = """
const gl = document.querySelector('.sdt-view canvas').getContext('webgl2');
const n = gl.drawingBufferWidth * gl.drawingBufferHeight, seen = new Uint8Array(4 * n), found = new Set();
gl.readPixels(0, 0, gl.drawingBufferWidth, gl.drawingBufferHeight, gl.RGBA, gl.UNSIGNED_BYTE, seen);
for (let i = 0; i < n; i += 7) found.add((seen[4 * i] << 16) | (seen[4 * i + 1] << 8) | seen[4 * i + 2]);
return found.size
"""


def test_the_page_plays_offline_as_pinocchio_moves(written: Written, browser: Browser) -> None:
    driver, view = browser.driver, "document.querySelector('.sdt-view').sdtView"
    driver.get(written.html.as_uri())
    browser.until(lambda: driver.execute_script(READY), "the scene")
    browser.until(lambda: driver.execute_script(COLORS) > 50, "kitchen, robot and shades of them")
    assert driver.execute_script(OPAQUE), "the page would shine through a ghost"
    found = judged("b", "stretch", f"open:{DRAWER}", drive="omni", budget=30.0, store=str(written.store))
    scene, (one,) = found.scenes["stretch"], found.all
    assert one.motion is not None
    assert driver.execute_script(f"return {view}.names") == [f"stretch: open {DRAWER}"]
    end = _coordinates(scene, one)
    for joint in (scene.names[scene.base[2]], scene.names[-1], one.container.joint):
        shown = driver.execute_script(f"return {view}.frame({joint!r})")
        scene.placement(end, scene.solids[-1].body)  # forward kinematics
        frame = scene.placements.world_T_joint[scene.model.getJointId(joint)].homogeneous
        assert pytest.approx(frame, abs=2e-4) == np.reshape(shown, (4, 4)).T, joint
    _plays_by_keyboard(browser)
    browser.resize(390, 800)
    assert driver.execute_script("return document.documentElement.scrollWidth") <= 390  # a phone
    assert browser.console_errors() == []
    assert browser.foreign_requests() == []


def _coordinates(scene: Scene, one: object) -> np.ndarray:
    """All coordinates at the end of the motion."""
    motion = one.motion
    robot = dict(zip(motion.joints, motion.q[-1], strict=True))
    kitchen = dict(zip(motion.kitchen_joints, motion.kitchen_q[-1], strict=True))
    return scene.q(motion.base[-1], robot, kitchen)


def _plays_by_keyboard(browser: Browser) -> None:
    driver = browser.driver
    driver.execute_script("document.querySelector('.sdt-clip').click()")  # the field of the matrix
    slider = driver.find_element("css selector", ".sdt-view input[type=range]")
    browser.until(lambda: slider.get_property("value") == "1000", "the end of the motion")
    canvas = driver.find_element("css selector", ".sdt-view canvas")
    speed = driver.find_element("css selector", ".sdt-view [aria-label=Speed]")
    # Time enough to be seen, and to be stopped by whoever is slow.
    driver.execute_script("arguments[0].options[0].value = 0.05", speed)
    speed.send_keys("× 1")
    canvas.send_keys(Keys.SPACE)
    browser.until(lambda: 0 < int(slider.get_property("value")) < 1000, "the middle of the motion")
    canvas.send_keys(Keys.SPACE)
    play = driver.find_element("css selector", ".sdt-view button")
    browser.until(lambda: play.text == "Play", "the motion stands")
    assert 0 < int(slider.get_property("value")) < 1000
    canvas.send_keys(Keys.ARROW_LEFT, "+")
