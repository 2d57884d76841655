"""Figures of `sdt view` in headless Chromium with software WebGL: ready, first verdict. `make bench`."""

import re
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager

import pytest

from tests.browser import Browser
from tests.services.viewer.person import Person

CASE = "case?kitchen=b&robot=pr2&task=open:sink_area_left_middle_drawer_main"
BLANK = "data:text/html,<canvas id=c></canvas><script>c.getContext('webgl2').clear(16384)</script>"
"""A person's browser runs already when `sdt view` answers; so does this one."""


@contextmanager
def sdt_view() -> Iterator[str]:
    """Address of a page in a process of its own, as soon as it says it."""
    command = [sys.executable, "-m", "services.cli", "view", "--http", "127.0.0.1:0"]
    with subprocess.Popen(command, stderr=subprocess.PIPE, text=True) as process:
        try:
            assert process.stderr is not None
            said = process.stderr.readline()
            found = re.search(r"http://\S+", said)
            assert found, said
            yield found[0]
        finally:
            process.terminate()


@pytest.mark.benchmark(group="view")
def test_ready_and_first_verdict_of_an_easy_drawer(benchmark, browser: Browser) -> None:
    person = Person(browser)
    figures = benchmark.extra_info
    browser.driver.get(BLANK)

    def looked() -> None:
        asked = time.perf_counter()
        with sdt_view() as address:
            began = time.perf_counter()
            figures["sdt view answers [s]"] = round(began - asked, 2)
            browser.driver.get(address + CASE)
            person.waits_for("Ready.")
            figures["page ready [s]"] = round(time.perf_counter() - began, 2)
            began = time.perf_counter()
            person.clicks("Check")
            person.waits_for("Judged in")
            figures["first verdict, clicked at once [s]"] = round(time.perf_counter() - began, 2)

    benchmark.pedantic(looked, rounds=1)
