"""The documentation page says everything that the ontology says, and needs nothing from elsewhere."""

import re
from html.parser import HTMLParser

import pytest
import rdflib
from rdflib.namespace import RDFS, SH

import ontology
from services.ontology_page.page import page


class Read(HTMLParser):
    """Tags, anchors, links and text of a page."""

    def __init__(self) -> None:
        super().__init__()
        self.tags: list[str] = []
        self.anchors: list[str] = []
        self.links: list[str] = []
        self.sources: list[str] = []
        self.words: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append(tag)
        for name, value in attrs:
            if name == "id":
                self.anchors.append(str(value))
            elif name == "href":
                self.links.append(str(value))
            elif name in {"src", "srcset", "action", "style"} or name.startswith("on"):
                self.sources.append(str(value))

    def handle_data(self, data: str) -> None:
        self.words.append(data)

    @property
    def text(self) -> str:
        return " ".join(" ".join(self.words).split())


@pytest.fixture(scope="module")
def read() -> Read:
    found = Read()
    found.feed(page())
    return found


def test_nothing_comes_from_elsewhere(read: Read) -> None:
    assert not {"script", "link", "img", "iframe", "base"} & set(read.tags)
    assert read.sources == []
    assert not re.search(r"url\(|@import", page())
    assert all(link.startswith("#") for link in read.links)


def test_every_link_leads_somewhere_and_no_place_has_two(read: Read) -> None:
    assert len(set(read.anchors)) == len(read.anchors)
    assert {link[1:] for link in read.links} <= set(read.anchors)


@pytest.mark.parametrize("name", ["sdt", "tee", "law"])
def test_every_term_is_there_with_its_comment(read: Read, name: str) -> None:
    graph = rdflib.Graph().parse(ontology.path(f"{name}.ttl"))
    own = [
        term
        for term in graph.subjects(RDFS.isDefinedBy)
        if str(term).startswith(f"https://example.org/{name}#")
    ]
    assert len(own) >= 10
    for term in own:
        assert f"{name}-{str(term).split('#')[1]}" in read.anchors
        assert " ".join(str(graph.value(term, RDFS.comment)).split()) in read.text


def test_every_message_of_a_shape_and_every_bound_is_there(read: Read) -> None:
    for path in ontology.path("shapes").glob("*.ttl"):
        for message in rdflib.Graph().parse(path).objects(None, SH.message):
            assert str(message) in read.text
    assert "sh:minInclusive 0" in read.text  # a zero is a bound too


@pytest.mark.parametrize(
    ("folder", "word"), [("rules", "Rule"), ("queries", "Question"), ("checks", "Must not")]
)
def test_every_rule_question_and_check_is_there(read: Read, folder: str, word: str) -> None:
    files = sorted(ontology.path(folder).glob("*.rq"))
    assert files
    for path in files:
        assert path.name.split(".")[0] in read.anchors
        (first,) = re.findall(rf"^# {word} +(.*)", path.read_text(), flags=re.MULTILINE)
        assert " ".join(first.split()) in read.text
