"""Every page by its address."""

from starlette.routing import Route

from services.http.pages.feasibility.containers import containers
from services.http.pages.feasibility.matrix import matrix
from services.http.pages.graph.console import console_routes
from services.http.pages.graph.vocabulary import ontology_page
from services.http.pages.home import home
from services.http.pages.session import sign_in, sign_out
from services.http.pages.verdicts.listing import listing
from services.http.pages.verdicts.results import results
from services.http.pages.view import routes, static
from services.http.pages.writing.forms import artefact, ask, recheck, recheck_result, sign_in_page


def site() -> list[Route]:
    """Routes of all pages but those of single resources, which are at their IRIs."""
    return [
        *routes("/", home, plain="/index"),
        *routes("/kitchens/{kitchen}/containers", containers),
        Route("/kitchens/{kitchen}/ask", ask, methods=["POST"]),
        *routes("/kitchens/{kitchen}", matrix),
        *routes("/verdicts", listing),
        *routes("/tasks", results),
        Route("/verdicts/{key}/recheck", recheck, methods=["POST"]),
        Route("/tasks/{key}/recheck", recheck_result, methods=["POST"]),
        Route("/verdicts/{key}/artefact", artefact),
        *console_routes(),
        Route("/sign-in", sign_in, methods=["POST"]),
        *routes("/sign-in", sign_in_page, table=False),
        Route("/sign-out", sign_out, methods=["POST"]),
        Route("/ontology", ontology_page),
        Route("/static/{name}", static),
    ]
