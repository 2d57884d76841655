"""A real headless Chromium, and what pages asked of it: requests, console messages, pictures."""

import json
import shutil
import time
from base64 import b64decode
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from ipaddress import ip_address
from pathlib import Path
from typing import TypeVar
from urllib.parse import urlsplit

import pytest
from selenium.common.exceptions import WebDriverException
from selenium.webdriver import Chrome, ChromeOptions, ChromeService

# Chromium's own calls home are switched off, so that a foreign request is one of the page's.
QUIET = (
    "--headless=new",
    "--no-sandbox",
    "--no-first-run",
    "--disable-quic",
    "--disable-sync",
    "--disable-component-update",
    "--disable-background-networking",
    "--disable-dev-shm-usage",
    "--hide-scrollbars",
    # Machines of tests have no graphics card: WebGL in software. How the rest is drawn is left to Chromium,
    # as it is on such a machine; told to draw that through the same software GPU, it makes WebGL wait for it.
    "--enable-unsafe-swiftshader",
)
T = TypeVar("T")
PATIENCE = 240
"""[s] Software WebGL on a busy machine is slow; figures are measured in tests/benchmarks."""
LOOK = 0.05
"""[s] Between two looks at the page."""
DOCUMENT = "return document.readyState === 'complete' ? performance.timeOrigin : null"
"""Which document is there, as soon as all of it is: when the way to it began."""
BEGINNING = "return document.body.innerText.slice(0, 2000)"
WEAK_TEXTS = Path(__file__).with_name("weak_texts.js").read_text()
LOCAL_SCHEMES = {"about", "blob", "chrome", "data", "devtools", "file"}


@dataclass(frozen=True)
class Browser:
    """Chromium with one window. What is read from a log is taken out of it."""

    driver: Chrome

    def until(self, seen: Callable[[], T], what: str) -> T:
        """What is seen at last, after a wait as long as a busy machine needs.

        A page that is being left or redrawn is looked at again: a driver has many ways to say that what it
        had found is gone, and only some of them are a StaleElementReferenceException.
        """
        end, trouble = time.monotonic() + PATIENCE, "nothing"
        while time.monotonic() < end:
            try:
                if found := seen():
                    return found
                trouble = "nothing"
            except WebDriverException as error:
                trouble = str(error.msg)
            time.sleep(LOOK)
        page = self.driver.execute_script(BEGINNING)
        pytest.fail(f"never seen: {what}; the driver says: {trouble}; the page says: {page}")

    def follows(self, act: Callable[[], object]) -> None:
        """Does what leads to another page, and waits for all of that page: a click alone does not."""
        before = self.driver.execute_script(DOCUMENT)
        act()
        self.until(lambda: self.driver.execute_script(DOCUMENT) not in {before, None}, "another page")

    def resize(self, width: int, height: int) -> None:
        """The page is width × height px, as on a phone or a laptop (a window cannot be narrower than 500)."""
        self.driver.execute_cdp_cmd(
            "Emulation.setDeviceMetricsOverride",
            {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": False},
        )
        size = "return innerWidth === arguments[0] && innerHeight === arguments[1]"
        self.until(lambda: self.driver.execute_script(size, width, height), f"{width} × {height} px")

    def console_errors(self) -> list[str]:
        """What the page wrote on the console as an error since the last call."""
        return [str(each["message"]) for each in self.driver.get_log("browser") if each["level"] == "SEVERE"]

    def foreign_requests(self) -> list[str]:
        """Addresses beyond this machine asked for since the last call."""
        return [url for url in self.requests() if not is_local(url)]

    def requests(self) -> Iterator[str]:
        """All addresses asked for since the last call."""
        for entry in self.driver.get_log("performance"):
            message = json.loads(str(entry["message"]))["message"]
            if message["method"] == "Network.requestWillBeSent":
                yield message["params"]["request"]["url"]
            elif message["method"] == "Network.webSocketCreated":
                yield message["params"]["url"]

    def weak_texts(self) -> list[object]:
        """Texts of the page whose contrast is below WCAG AA: [ratio, text]; the page has some text."""
        found = self.driver.execute_script(WEAK_TEXTS)
        assert found["seen"] > 0, "no text"
        return found["weak"]

    def picture(self, path: Path) -> None:
        """The whole page as PNG."""
        path.parent.mkdir(parents=True, exist_ok=True)
        # WebDriver's own command gives up after 10 s, which software WebGL on a busy machine needs.
        taken = self.driver.execute_cdp_cmd("Page.captureScreenshot", {"format": "png"})
        path.write_bytes(b64decode(taken["data"]))


def is_local(url: str) -> bool:
    """Whether the address is of this machine, or of no machine."""
    parts = urlsplit(url)
    if parts.scheme in LOCAL_SCHEMES:
        return True
    host = parts.hostname or ""
    try:
        return ip_address(host).is_loopback
    except ValueError:
        return host == "localhost"


def installed() -> bool:
    """Chromium and its driver are on the PATH."""
    return shutil.which("chromium") is not None and shutil.which("chromedriver") is not None


@contextmanager
def started(width: int = 1280, height: int = 720) -> Iterator[Browser]:
    """A browser with an empty profile, gone at the end."""
    options = ChromeOptions()
    options.binary_location = str(shutil.which("chromium"))
    for argument in (*QUIET, f"--window-size={width},{height}"):
        options.add_argument(argument)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
    driver = Chrome(options=options, service=ChromeService(shutil.which("chromedriver")))
    driver.set_script_timeout(PATIENCE)
    try:
        browser = Browser(driver)
        browser.resize(width, height)
        yield browser
    finally:
        driver.quit()
