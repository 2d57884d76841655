"""Pages in a real browser: nothing foreign, no error, by keyboard, on a phone, with our script or none."""

import csv
import io
from collections.abc import Iterator
from contextlib import contextmanager

import httpx
import pytest
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys

from tests.browser import PATIENCE, Browser

SPARQL = (
    "SELECT ?container ?outcome WHERE { ?v law:container ?container ; law:outcome ?outcome ; law:robot ?r }"
)


def links(address: str) -> dict[str, str]:
    """Every kind of page, by what it is."""
    rows = httpx.get(f"{address}/verdicts.json", timeout=PATIENCE).json()["verdicts"]
    of = {row["outcome"]: row["link"] for row in rows}
    found = {
        "start": "/",
        "matrix": "/kitchens/a",
        "containers": "/kitchens/a/containers",
        "list": "/verdicts",
    }
    found |= {"console": f"/console?query={SPARQL}", "entity": "/id/a/body/low_drawer"}
    return found | of


@contextmanager
def without_script(browser: Browser) -> Iterator[None]:
    browser.driver.execute_cdp_cmd("Emulation.setScriptExecutionDisabled", {"value": True})
    try:
        yield
    finally:
        browser.driver.execute_cdp_cmd("Emulation.setScriptExecutionDisabled", {"value": False})


def case(browser: Browser, robot: str, container: str):
    return browser.driver.find_element(By.ID, f"{robot}.{container}")


@pytest.mark.oracle
def test_pages_are_usable_on_a_laptop_on_a_phone_and_by_keyboard(browser: Browser, address: str) -> None:
    driver = browser.driver
    for name, link in links(address).items():
        driver.get(address + link)
        for width, height in ((1280, 720), (390, 844)):
            browser.resize(width, height)
            wide = driver.execute_script("return document.documentElement.scrollWidth")
            assert wide <= width, (name, width, wide)
        driver.find_element(By.TAG_NAME, "body").send_keys(Keys.TAB)
        assert driver.switch_to.active_element.get_attribute("class") == "skip", name
        outline = driver.execute_script("return getComputedStyle(document.activeElement).outlineStyle")
        assert outline != "none", name
        driver.switch_to.active_element.send_keys(Keys.ENTER)
        browser.until(lambda: driver.switch_to.active_element.get_attribute("id") == "main", name)
    assert browser.console_errors() == []
    assert browser.foreign_requests() == []


@pytest.mark.oracle
def test_a_case_is_asked_for_by_keyboard_and_its_verdict_followed(browser: Browser, address: str) -> None:
    """Out of scope, so that it takes no planner."""
    driver = browser.driver
    driver.get(f"{address}/kitchens/a")
    button = case(browser, "pr2", "swing_door").find_element(By.TAG_NAME, "button")
    assert button.get_attribute("aria-label") == "Ask whether pr2 can open swing_door"
    button.send_keys(Keys.ENTER)
    # The page replaces its matrix while it follows the case.
    browser.until(lambda: "out of scope" in case(browser, "pr2", "swing_door").text, "the verdict")
    assert driver.current_url.endswith("#pr2.swing_door")
    browser.follows(case(browser, "pr2", "swing_door").find_element(By.TAG_NAME, "a").click)
    assert driver.find_element(By.CLASS_NAME, "outcome").text == "Abstained"
    assert "Can pr2 open swing_door in kitchen a?" in driver.find_element(By.TAG_NAME, "h1").text.replace(
        "\u200b", ""
    )
    assert browser.console_errors() == []
    assert browser.foreign_requests() == []


@pytest.mark.oracle
def test_the_console_is_asked_by_keyboard_and_its_answer_taken_as_csv(browser: Browser, address: str) -> None:
    driver = browser.driver
    driver.get(f"{address}/console")
    area = driver.find_element(By.ID, "query")
    area.clear()
    area.send_keys(SPARQL)
    browser.follows(
        ActionChains(driver).key_down(Keys.CONTROL).send_keys(Keys.ENTER).key_up(Keys.CONTROL).perform
    )
    shown = [
        [cell.text.replace("\u200b", "") for cell in row.find_elements(By.TAG_NAME, "td")]
        for row in driver.find_elements(By.CSS_SELECTOR, "#answer tbody tr")
    ]
    taken = driver.find_element(By.LINK_TEXT, "CSV").get_attribute("href")
    rows = list(csv.reader(io.StringIO(httpx.get(str(taken), timeout=PATIENCE).text)))
    assert rows[0] == ["container", "outcome"]
    short = [[each.rsplit("/", 1)[-1].replace("law#", "law:") for each in row] for row in rows[1:]]
    assert sorted(short) == sorted([each.rsplit("/", 1)[-1] for each in row] for row in shown)
    browser.follows(driver.find_element(By.CSS_SELECTOR, "#answer tbody a").click)
    assert "/id/a/body/" in driver.current_url
    assert browser.console_errors() == []


@pytest.mark.oracle
def test_everything_works_without_script(browser: Browser, address: str) -> None:
    driver = browser.driver
    with without_script(browser):
        closing = f"{address}/kitchens/a?task=close"
        driver.get(closing)
        browser.follows(case(browser, "stretch", "swing_door").find_element(By.TAG_NAME, "button").click)

        def judged() -> bool:
            driver.get(closing)
            return "out of scope" in case(browser, "stretch", "swing_door").text

        browser.until(judged, "the verdict")
        driver.get(f"{address}/console")
        browser.follows(driver.find_element(By.CSS_SELECTOR, "#query-form button").click)
        assert driver.find_elements(By.CSS_SELECTOR, "#answer table")
    assert browser.console_errors() == []
