"""The page in a real browser: ready, a verdict, files that are none; nothing leaves the machine."""

from collections.abc import Iterator
from pathlib import Path

import pytest
from selenium.webdriver.common.by import By

from services.viewer.page import Page
from services.viewer.running import Offer, running
from tests.browser import Browser
from tests.services.viewer.person import Person


@pytest.fixture(scope="module")
def page() -> Iterator[Page]:
    with running("127.0.0.1:0", Offer(("b",), ("pr2",))) as one:
        yield one


@pytest.mark.oracle
def test_a_case_is_judged_and_what_is_no_input_is_said_as_on_the_shell(
    browser: Browser, page: Page, tmp_path: Path
) -> None:
    person = Person(browser)
    task = "open:sink_area_left_middle_drawer_main"
    browser.driver.get(f"{page.url}case?kitchen=b&robot=pr2&task={task}")
    person.waits_for("Ready.")
    person.clicks("Check")
    said = person.waits_for("Judged in")
    assert "CERTIFIED\n" in said
    assert "Can pr2 open sink_area_left_middle_drawer_main in kitchen b?" in said
    for predicate in ("SatisfiesRequest", "Causes", "CanPerform"):
        assert f"{predicate}\t✓ yes" in said
    assert "drive → approach → grasp → follow" in said

    person.clicks("Files")
    person.until(
        lambda: len(browser.driver.find_elements(By.CSS_SELECTOR, "input[type=file]")) == 2, "buttons"
    )
    broken, wrong, large = tmp_path / "broken.urdf", tmp_path / "wrong.csv", tmp_path / "large.npz"
    broken.write_text("<robot name='r'><link name='a'/><link name='b'/></robot>")
    wrong.write_text("time,elbow\n0,0\n1,zero\n")
    with large.open("wb") as hole:
        hole.truncate(300 * 2**20)
    person.opens(1, broken)
    person.waits_for("2 links without parent: 'a', 'b'; allowed: one root")
    person.opens(0, wrong)
    person.waits_for("'zero' in the column elbow of line 3 is no number")
    person.opens(0, large)
    person.waits_for("'large.npz' has 300 MB; allowed: 32 MB")
    assert browser.console_errors() == []
    assert browser.foreign_requests() == []
