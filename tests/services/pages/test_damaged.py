"""A record that was changed before the service began: in no list, matrix or count, and its page says why."""

from contextlib import closing
from pathlib import Path

from services.store.files import opened
from tests.services.http.conftest import Serve, serve
from tests.services.pages.conftest import PAGE, verdict_link

__all__ = ["serve"]
COUNT = "SELECT (COUNT(?v) AS ?n) { ?v a law:Verdict }"


def test_what_was_changed_is_counted_nowhere(serve: Serve, seed: Path, tmp_path: Path) -> None:
    models = {"kitchens": ("a",), "robots": ("pr2", "stretch")}
    with closing(opened(seed)) as archive:
        sound = serve(**models, archive=archive)
        link = verdict_link(sound, robot="stretch", container="high_drawer")
    key = link.rpartition("/")[2]
    copy = tmp_path / "changed.nq"
    was = seed.read_text()
    for line in was.splitlines():
        if f"verdict/{key}> <https://example.org/law#outcome>" in line:
            copy.write_text(was.replace(line, line.replace("law#NotCertified", "law#Certified")))
    with closing(opened(copy)) as archive:
        served = serve(**models, archive=archive)
        cells = served.get("/kitchens/a.json").json()["cells"]
        (cell,) = [each for each in cells if (each["robot"], each["container"]) == ("stretch", "high_drawer")]
        assert (cell["standing"], cell["verdict"]) == ("not_judged", None)
        assert len(served.get("/verdicts.json").json()["verdicts"]) == 7
        rows = served.get("/sparql", params={"query": COUNT}).json()["results"]["bindings"]
        assert rows[0]["n"]["value"] == "7"
        page = served.get(link, headers=PAGE).text
        assert "This record cannot be read" in page
        assert "was changed after it was written" in page
