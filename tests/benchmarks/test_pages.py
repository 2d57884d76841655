"""How long pages take with the verdicts of kitchen B and three robots: `make bench`."""

import statistics
import time
from collections.abc import Iterator

import httpx
import pytest
from click.testing import CliRunner

from services.commands.law.table import table
from tests.services.pages.conftest import sdt_serve

MODELS = ("--kitchen", "b", "--robot", "pr2", "--robot", "tiago_dual", "--robot", "stretch")
PAGES = {
    "matrix": "/kitchens/b?drive=omni",
    "containers": "/kitchens/b/containers",
    "list": "/verdicts",
    "list, longest first": "/verdicts?sort=seconds",
    "console": "/console?query=SELECT+?v+?o+WHERE+{+?v+law:outcome+?o+}",
    "entity": "/id/b/body/iai_fridge_door",
}
ROUNDS = 7


@pytest.fixture(scope="module")
def address(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    store = str(tmp_path_factory.mktemp("pages") / "verdicts.nq")
    judged = ["--kitchens", "b", "--drive", "omni", "--jobs", "2", "--save", store]
    assert CliRunner().invoke(table, judged, catch_exceptions=False).exit_code == 0
    with sdt_serve(*MODELS, "--store", store) as where:
        yield where


def test_pages_of_a_kitchen_that_was_judged(benchmark, address: str) -> None:
    with httpx.Client(base_url=address, timeout=60) as client:
        verdict = client.get("/verdicts.json").json()["verdicts"][0]["link"]
        pages = PAGES | {"verdict": verdict}

        def took(link: str) -> float:
            began = time.perf_counter()
            answer = client.get(link, headers={"Accept": "text/html"}, follow_redirects=True)
            assert answer.status_code == 200, answer.text
            return 1000 * (time.perf_counter() - began)

        for name, link in pages.items():
            took(link)  # the first time a template is compiled
            benchmark.extra_info[f"{name} [ms]"] = round(
                statistics.median(took(link) for _ in range(ROUNDS)), 1
            )
        benchmark.pedantic(took, args=(pages["matrix"],), rounds=ROUNDS)
