"""Pages over kitchen B: a drawer is asked for in a browser and its certificate rechecked."""

import time
from pathlib import Path

import httpx
import pytest
from selenium.webdriver.common.by import By

from tests.browser import PATIENCE, Browser
from tests.ports import free_port
from tests.services.pages.conftest import TOKEN, sdt_serve
from tests.services.viewer.person import Person

CONTAINER = "sink_area_left_middle_drawer_main"


@pytest.mark.oracle
@pytest.mark.slow
def test_a_drawer_from_question_to_rechecked_certificate(browser: Browser, tmp_path: Path) -> None:
    options = ("--kitchen", "b", "--robot", "pr2", "--store", str(tmp_path / "verdicts.nq"))
    driver = browser.driver
    with sdt_serve(*options, token=TOKEN) as address:
        driver.get(f"{address}/kitchens/b")
        browser.follows(driver.find_element(By.LINK_TEXT, "Sign in").click)
        driver.find_element(By.NAME, "token").send_keys(TOKEN)
        browser.follows(driver.find_element(By.CSS_SELECTOR, "main button").click)
        assert driver.current_url == f"{address}/kitchens/b"

        def cell():
            return driver.find_element(By.ID, f"pr2.{CONTAINER}")

        began = time.monotonic()
        cell().find_element(By.TAG_NAME, "button").click()
        browser.until(lambda: "certified" in cell().text, "a verdict")
        print(f"first verdict {time.monotonic() - began:.1f} s after the click")  # noqa: T201 - a figure
        browser.follows(cell().find_element(By.TAG_NAME, "a").click)
        assert driver.find_element(By.CLASS_NAME, "outcome").text == "Certified"
        link = driver.current_url
        browser.follows(driver.find_element(By.XPATH, "//button[text()='Recheck now']").click)
        assert "It holds" in driver.find_element(By.CSS_SELECTOR, ".notice.good").text
        data = httpx.get(f"{link.partition('#')[0]}.json", timeout=PATIENCE).json()
        assert (data["recheck"]["holds"], data["artefact"]["kind"]) == (True, "certificate")
        taken = httpx.get(f"{address}/verdicts/{data['name']}/artefact", timeout=PATIENCE)
        assert len(taken.content) == data["artefact"]["bytes"]
        assert browser.console_errors() == []
        assert browser.foreign_requests() == []


@pytest.mark.oracle
@pytest.mark.slow
def test_a_cell_leads_to_its_case_on_the_3d_page_beside_the_pages(browser: Browser) -> None:
    options = ("--kitchen", "b", "--robot", "pr2", "--view", f"127.0.0.1:{free_port()}")
    with sdt_serve(*options) as address:
        person = Person(browser)
        browser.driver.get(f"{address}/kitchens/b?state=iai_fridge_door%3D0.4")
        cell = browser.driver.find_element(By.ID, f"pr2.{CONTAINER}")
        browser.driver.get(str(cell.find_element(By.CLASS_NAME, "in-3d").get_attribute("href")))
        person.waits_for("Ready.")
        person.clicks("Check")
        said = person.waits_for("Judged in")
        assert "CERTIFIED\n" in said
        assert f"Can pr2 open {CONTAINER} in kitchen b?" in said
        folded = str(browser.driver.execute_script("return document.body.textContent"))
        assert "kitchen: iai_fridge_door_joint at 0.4" in folded
        assert browser.console_errors() == []
        assert browser.foreign_requests() == []
