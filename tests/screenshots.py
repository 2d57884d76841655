"""Pictures of every page and report, to be looked at: `make screenshots`, after `make demo`."""

import json
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from urllib.request import urlopen

from services.viewer.running import Offer, running
from tests.browser import Browser, started
from tests.services.pages.conftest import sdt_serve

ROBOTS = ("pr2", "tiago_dual", "stretch")
REPORTS = ("feasibility", "counterfactual", "codesign", "diagnosis", "learning")
WITHOUT_STORE = ("learning",)
SHOWN = {"diagnosis": ("-p", "edits=box:crate=0.3,0.3,0.4@0.6,-0.6,0.2")}
"""What is asked for a picture with something to see."""
WIDTH, HEIGHT = 1280, 720
TALLEST = 6000
"""[px] Of a picture."""

DRAWN = 20.0
"""[s] Software WebGL takes its time."""

PRESS = "[...document.querySelectorAll('button')].find(b => b.innerText.trim() == arguments[0]).click()"

CERTIFIED = "case?kitchen=b&robot=pr2&drive=omni&task=open:iai_fridge_door"
REFUSED = "case?kitchen=a&robot=stretch&drive=omni&task=open:cabinet4_door_bottom"


def taken(browser: Browser, url: str, path: Path, width: int = WIDTH) -> None:
    """A picture of the whole page."""
    browser.resize(width, HEIGHT)
    browser.driver.get(url)
    height = int(str(browser.driver.execute_script("return document.documentElement.scrollHeight")))
    browser.resize(width, min(max(height, HEIGHT), TALLEST))
    browser.picture(path)
    print(path)  # noqa: T201 - what was made


def pages(browser: Browser, store: Path, folder: Path) -> None:
    """Pages of `sdt serve`, on a laptop and, some of them, on a phone."""
    models = [option for each in ("a", "b") for option in ("--kitchen", each)]
    models += [option for each in ROBOTS for option in ("--robot", each)]
    with sdt_serve(*models, "--store", str(store)) as address:
        with urlopen(f"{address}/verdicts.json") as answer:  # noqa: S310 - our own address
            verdicts = json.load(answer)["verdicts"]
        outcomes = {each["outcome"]: each["link"] for each in verdicts}
        shown = {"home": "/", "containers": "/kitchens/b/containers", "verdicts": "/verdicts"}
        shown |= {"console": "/console", "matrix": "/kitchens/a?drive=omni", "ontology": "/ontology"}
        shown |= {f"verdict_{outcome}": link for outcome, link in outcomes.items()}
        for name, path in shown.items():
            taken(browser, address + path, folder / f"page_{name}.png")
        taken(browser, f"{address}/kitchens/a?drive=omni", folder / "phone_matrix.png", 390)


def views(browser: Browser, folder: Path) -> None:
    """The 3D page with a motion that is certified, and with one that is refused."""
    with running("127.0.0.1:0", Offer(("b", "a"), ROBOTS)) as page:
        for name, case in (("certified", CERTIFIED), ("refused", REFUSED)):
            browser.resize(WIDTH, HEIGHT)
            browser.driver.get(f"{page.url}{case}")
            _pressed(browser, "Check", "Judged in")
            # What viser says of software WebGL: nothing that people with a graphics card see.
            browser.driver.execute_script(
                "document.querySelectorAll('.mantine-Notification-closeButton').forEach(b => b.click())"
            )
            time.sleep(DRAWN)
            browser.picture(folder / f"view_{name}.png")
            print(folder / f"view_{name}.png")  # noqa: T201 - what was made


def reports(browser: Browser, store: Path, folder: Path) -> None:
    """Every report with its own parameters."""
    for name in REPORTS:
        html = folder / f"report_{name}.html"
        command = (sys.executable, "-m", "services.cli", "report", name, "-o", str(html))
        takes_store = () if name in WITHOUT_STORE else ("--store", str(store))
        subprocess.run((*command, *takes_store, *SHOWN.get(name, ())), check=True)
        taken(browser, html.absolute().as_uri(), html.with_suffix(".png"))


def _pressed(browser: Browser, label: str, answer: str) -> None:
    """The button is pressed as soon as the page is ready, and the page has answered."""
    for text, then in (("Ready.", label), (answer, None)):
        while text not in str(browser.driver.execute_script("return document.body.innerText")):
            time.sleep(0.2)
        if then:
            browser.driver.execute_script(PRESS, then)


@contextmanager
def _browser() -> Iterator[Browser]:
    with started(WIDTH, HEIGHT) as browser:
        browser.driver.set_script_timeout(300)
        yield browser


def main(folder: Path, store: Path) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    with _browser() as browser:
        pages(browser, store, folder)
        views(browser, folder)
        reports(browser, store, folder)


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]))
