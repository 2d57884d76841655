"""What somebody at the page does and reads."""

from collections.abc import Callable
from pathlib import Path

import pytest
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys
from selenium.webdriver.remote.webelement import WebElement

from tests.browser import Browser

FOCUSED = """
    const at = document.activeElement;
    const label = ((at.labels && at.labels.length ? at.labels[0].innerText : at.innerText) || '').trim();
    return [label, getComputedStyle(at).outlineStyle];
"""
NAMED = """
    const [selector, label] = arguments;
    return [...document.querySelectorAll(selector)].filter(each => each.innerText.trim() === label);
"""
"""In one step, since the page is drawn again between two."""
CONTROLS = "button, [role=tab]"


class Person:
    """Somebody with a browser."""

    def __init__(self, browser: Browser) -> None:
        self.browser, self.driver = browser, browser.driver

    def reads(self) -> str:
        return str(self.driver.execute_script("return document.body.innerText"))

    def waits_for(self, text: str) -> str:
        return self.until(lambda: text in self.reads(), text)

    def until(self, seen: Callable[[], bool], what: str) -> str:
        self.browser.until(seen, what)
        return self.reads()

    def clicks(self, label: str, selector: str = CONTROLS) -> None:
        def clicked() -> bool:
            self.named(label, selector).click()
            return True

        self.browser.until(clicked, f"{selector} named {label}")

    def named(self, label: str, selector: str = CONTROLS) -> WebElement:
        """The only one of these that says so, as soon as it is there."""
        found = self.browser.until(lambda: self.driver.execute_script(NAMED, selector, label), label)
        assert len(found) == 1, (label, len(found))
        return found[0]

    def ticks(self, label: str) -> None:
        """Ticks a box, or takes its tick away."""
        self.clicks(label, "label")

    def presses(self, key: str) -> None:
        """Presses a key, whatever has the focus."""
        ActionChains(self.driver).send_keys(key).perform()

    def tabs_to(self, label: str) -> None:
        """Goes on with the tab key until what has that label has the focus, and shows it."""
        for _ in range(80):
            self.presses(Keys.TAB)
            focused, outline = self.driver.execute_script(FOCUSED)
            if focused == label:
                assert outline != "none", f"{label} does not show that it has the focus"
                return
        pytest.fail(f"not reached by keyboard: {label}")

    def opens(self, position: int, file: Path) -> None:
        """Chooses a file at the button of that position."""
        found = "input[type=file]"
        self.until(lambda: len(self.driver.find_elements(By.CSS_SELECTOR, found)) > position, found)
        self.driver.find_elements(By.CSS_SELECTOR, found)[position].send_keys(str(file))
