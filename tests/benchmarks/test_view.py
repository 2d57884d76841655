"""Figures of the 3D page in headless Chromium with software WebGL: ready, first verdict. `make bench`."""

import time

import pytest

from services.viewer.running import Offer, running
from tests.browser import Browser
from tests.services.viewer.person import Person

CASE = "case?kitchen=b&robot=pr2&task=open:sink_area_left_middle_drawer_main"


@pytest.mark.benchmark(group="view")
def test_ready_and_first_verdict_of_an_easy_drawer(benchmark, browser: Browser) -> None:
    person = Person(browser)
    figures = benchmark.extra_info

    def looked() -> None:
        with running("127.0.0.1:0", Offer(("b", "a"), ("pr2", "tiago_dual", "stretch"))) as page:
            began = time.perf_counter()
            browser.driver.get(page.url + CASE)
            person.waits_for("Ready.")
            figures["page ready [s]"] = round(time.perf_counter() - began, 2)
            began = time.perf_counter()
            person.clicks("Check")
            person.waits_for("Judged in")
            figures["first verdict, clicked at once [s]"] = round(time.perf_counter() - began, 2)

    benchmark.pedantic(looked, rounds=1)
