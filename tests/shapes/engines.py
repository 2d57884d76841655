"""A second SHACL engine, for tests only: what one overlooks the other may find."""

import rdflib
import shifty

from sdt_kg.shacl import Engine, pyshacl_report


def pyshifty_report(data: rdflib.Graph, shapes: rdflib.Graph) -> rdflib.Graph:
    """The validation report of pyshifty, without inference."""
    return shifty.validate(data, shapes, infer=False)[1]


ENGINES: dict[str, Engine] = {"pyshacl": pyshacl_report, "pyshifty": pyshifty_report}
