"""The page: jinja2 with everything escaped, no script, nothing from elsewhere."""

from functools import cache
from pathlib import Path

from jinja2 import Environment, FileSystemLoader, StrictUndefined
from markupsafe import Markup, escape

from services.ontology_page.read import VOCABULARIES, alignments, queries, shapes, vocabulary

SHAPES = {
    "sdt": "every twin",
    "d_artic": "D_artic: T, E, R and I_Φ",
    "d_artic_dyn": "D_artic_dyn: I_Φ of forces",
    "task": "task specifications",
}


def page() -> str:
    """The whole page as HTML."""
    vocabularies = [vocabulary(name) for name in VOCABULARIES]
    shown = {term.name for each in vocabularies for terms in each.terms.values() for term in terms}

    def linked(text: str) -> Markup:
        """The text, words that name a term of the page made links."""
        words = (_link(word) if word in shown else escape(word) for word in str(text).split(" "))
        return Markup(" ").join(words)

    environment = _environment()
    environment.filters["linked"] = linked
    return environment.get_template("page.html.jinja").render(
        vocabularies=vocabularies,
        shapes={(name, title): shapes(name) for name, title in SHAPES.items()},
        rules=queries("rules/*.rq"),
        questions=queries("queries/cq*.rq"),
        services=[each for each in queries("queries/*.rq") if not each.name.startswith("cq")],
        checks=queries("checks/*.rq"),
        alignments=alignments(),
    )


def anchor(name: str) -> str:
    """Fragment of a term: `law:Verdict` → `law-Verdict`."""
    return name.replace(":", "-")


def _link(name: str) -> Markup:
    return Markup('<a href="#{}">{}</a>').format(anchor(name), name)


@cache
def _environment() -> Environment:
    loader = FileSystemLoader(Path(__file__).parent)
    environment = Environment(loader=loader, autoescape=True, undefined=StrictUndefined, trim_blocks=True)
    environment.filters["anchor"] = anchor
    return environment
