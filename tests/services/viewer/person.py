"""What somebody at the page does and reads."""

import time
from collections.abc import Callable
from pathlib import Path

import pytest
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys

from tests.browser import Browser

PATIENCE = 200
"""[s] Software WebGL on a busy machine is slow; figures are measured in tests/benchmarks."""

FOCUSED = """
    const at = document.activeElement;
    return ((at.labels && at.labels.length ? at.labels[0].innerText : at.innerText) || '').trim();
"""


class Person:
    """Somebody with a browser."""

    def __init__(self, browser: Browser) -> None:
        self.browser, self.driver = browser, browser.driver
        self.driver.set_script_timeout(PATIENCE)

    def reads(self) -> str:
        return str(self.driver.execute_script("return document.body.innerText"))

    def waits_for(self, text: str) -> str:
        return self.until(lambda: text in self.reads(), text)

    def until(self, seen: Callable[[], bool], what: str) -> str:
        end = time.monotonic() + PATIENCE
        while time.monotonic() < end:
            if seen():
                return self.reads()
            time.sleep(0.02)
        pytest.fail(f"never seen: {what}; the page says: {self.reads()}")

    def clicks(self, label: str) -> None:
        named = self.driver.find_elements(By.CSS_SELECTOR, "button, [role=tab]")
        (found,) = (each for each in named if each.text.strip() == label)
        found.click()

    def tabs_to(self, label: str) -> None:
        """Goes on with the tab key until what has that label has the focus, and shows it."""
        for _ in range(80):
            self.driver.switch_to.active_element.send_keys(Keys.TAB)
            if self.driver.execute_script(FOCUSED) == label:
                outline = self.driver.execute_script(
                    "return getComputedStyle(document.activeElement).outlineStyle"
                )
                assert outline != "none", f"{label} does not show that it has the focus"
                return
        pytest.fail(f"not reached by keyboard: {label}")

    def ticks(self, label: str) -> None:
        """Ticks a box, or takes its tick away."""
        named = self.driver.find_elements(By.TAG_NAME, "label")
        (found,) = (each for each in named if each.text.strip() == label)
        found.click()

    def opens(self, position: int, file: Path) -> None:
        """Chooses a file at the button of that position."""
        self.driver.find_elements(By.CSS_SELECTOR, "input[type=file]")[position].send_keys(str(file))

    def chooses(self, label: str, option: str) -> None:
        """In the drop-down of that label."""
        script = """
            const all = [...document.querySelectorAll('label, div, p')];
            const rows = all.filter(each => each.innerText === arguments[0]);
            const row = rows[rows.length - 1].closest('div[class]').parentElement;
            return row.querySelector('input') || row.parentElement.querySelector('input');
        """
        self.driver.execute_script(script, label).click()
        found = self.driver.find_elements(By.CSS_SELECTOR, "[role=option]")
        (wanted,) = (each for each in found if each.text.strip() == option)
        wanted.click()
