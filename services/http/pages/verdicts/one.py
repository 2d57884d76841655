"""One verdict: what was asked, what each predicate says, why, on what it rests, and how to check it again."""

import hashlib
from collections.abc import Callable
from typing import Final

import pyoxigraph as ox
from starlette.requests import Request

from predicates.case import Artefact, Diagnosis, Evidence, Outcome
from predicates.margins import at_least, told_figures
from predicates.record import StoredVerdict, read_verdict
from predicates.record.facts import Facts
from predicates.record.inputs import START_INPUT, TURNED, UNKNOWN_INPUT
from predicates.record.report import pair_json
from predicates.record.stored import read_positions
from predicates.scope import tee_class_of_hash
from sdt_kg.errors import InputError
from sdt_kg.iri import ID, LAW, Iri, local_name
from services.http.api.read import finite, of_models
from services.http.pages.kinds import VERDICT_STANDINGS, Standing
from services.http.pages.terms import Cell, iri_cell
from services.http.pages.view import Json, View
from services.http.pages.writing.recheck import Rechecks
from services.versions import outdated
from services.why import PREDICATES, nothing_kept, outcome, question, sections, used

EVIDENCE: Final = (
    "diagnosis",
    "kind",
    "quantity",
    "of",
    "value",
    "bound",
    "unit",
    "time",
    "proved",
    "reason",
)
TOLD: Final = ("Asked", "Notes", "To check again")
"""Parts of the story that are shown as they are told on the shell."""


def verdict(request: Request, iri: Iri, quads: list[ox.Quad]) -> View:
    """The page of a verdict, whose graph these quads are; a damaged record says so and claims nothing."""
    return or_damaged(lambda: _read(request, iri, quads), iri, EVIDENCE)


def or_damaged(read: Callable[[], View], iri: Iri, columns: tuple[str, ...]) -> View:
    """What is read from a record; of one that cannot be read, that it is damaged."""
    try:
        return read()
    except InputError as error:
        return View("damaged", {"iri": iri, "name": local_name(iri), "damage": str(error)}, (), columns)


def _read(request: Request, iri: Iri, quads: list[ox.Quad]) -> View:
    stored, facts = read_verdict(quads, iri), Facts(quads)
    told = {each.title: list(each.lines) for each in sections(quads, iri)}
    data: Json = _data(stored, facts, told) | {"recheck": rechecks(request).known(iri, quads)}
    models = {f"{name}_model": value for name, value in stored.inputs if name in {"environment", "robot"}}
    data |= of_models(request.app.state.world, models)
    shown: Json = {
        "outcome_words": outcome(stored),
        "standings": _standings(stored),
        "proved": any(each.proof for each in stored.diagnoses),
        "told": {name: told.get(name, []) for name in TOLD},
        "links": _links(stored),
        "answers": [
            (name, f"/id/{iri.removeprefix(ID)}/answer/{index}")
            for index, (name, holds) in enumerate(_holds(stored), 1)
            if holds is not None
        ],
        "path": "/id/" + iri.removeprefix(ID),
        "graph": "/id/graph/verdict/" + local_name(iri),
        "base": _base(stored),
        "used": list(used(stored.inputs)),
        "told_figures": list(told_figures(stored.figures)),
        "nothing_kept": nothing_kept(stored),
        "commands": [each for each in told.get("To check again", []) if each.startswith("sdt ")],
    }
    return View("verdict", data, data["diagnoses"], EVIDENCE, shown)


def _data(stored: StoredVerdict, facts: Facts, told: dict[str, list[str]]) -> Json:
    """The verdict as a JSON object."""
    figures, bounds, pairs = stored.figures.items(), at_least(stored.figures), stored.nearest_pairs
    return {
        "iri": stored.iri,
        "name": local_name(stored.iri),
        "question": question(stored),
        "outcome": stored.outcome.value,
        "outdated": list(outdated(dict(stored.inputs))),
        "means": " ".join(next(iter(told.values()))),
        "kitchen": local_name(stored.environment),
        "robot": local_name(stored.robot) if stored.robot else None,
        "task": stored.verb.value if stored.verb else None,
        "container": local_name(stored.container) if stored.container else None,
        "drive": facts.text(stored.iri, LAW + "drive"),
        "state": [f"{local_name(joint)}={at!r}" for joint, at in read_positions(facts, stored.iri).items()],
        "tee_class": _tee(stored),
        "predicates": _predicates(stored, facts),
        "diagnoses": [_evidence(index, each) for index, each in enumerate(stored.diagnoses, 1)],
        "margins": [
            {
                "name": name,
                "value": finite(at),
                "unit": unit,
                "at_least": name in bounds,
                "nearest": pair_json(pairs[name]) if name in pairs else None,
            }
            for name, (at, unit) in figures
        ],
        "artefact": _artefact(stored.artefact),
        "inputs": {name: value for name, value in stored.inputs if value != UNKNOWN_INPUT},
        "seconds": stored.seconds,
        "why": told,
    }


def rechecks(request: Request) -> Rechecks:
    """What was checked again since the service began."""
    return request.app.state.rechecks


def _standings(stored: StoredVerdict) -> list[str]:
    """Keys of the marks of the verdict, in the order of the other pages; of an outdated one that alone."""
    if outdated(dict(stored.inputs)):
        return [Standing.OUTDATED.value.key]
    if stored.outcome is Outcome.CERTIFIED:
        return [Standing.CERTIFIED.value.key]
    found = {each.kind.value for each in stored.diagnoses}
    return [each.value.key for each in VERDICT_STANDINGS if each.value.key in found]


def _predicates(stored: StoredVerdict, facts: Facts) -> list[Json]:
    """The three relations of Eq. (4), in its order."""
    answers = {
        local_name(facts.needed(of, LAW + "predicate")): of for of in facts.all(stored.iri, LAW + "answer")
    }
    return [
        {
            "name": name,
            "holds": answer,
            "means": meaning,
            "answered_by": facts.text(answers[name], LAW + "version") if name in answers else None,
            "seconds": facts.number(answers[name], LAW + "seconds") if name in answers else None,
        }
        for (name, answer), meaning in zip(_holds(stored), PREDICATES.values(), strict=True)
    ]


def _holds(stored: StoredVerdict) -> list[tuple[str, bool | None]]:
    """What each predicate says; None where it was not asked."""
    said = (stored.satisfies_request, stored.causes, stored.can_perform)
    return list(zip(PREDICATES, said, strict=True))


def _evidence(index: int, diagnosis: Diagnosis) -> Json:
    """A diagnosis with what it rests on: a measurement, a SHACL result, a proof or a search."""
    row: Json = {
        "diagnosis": index,
        "kind": diagnosis.kind.value,
        "code": diagnosis.code.value if diagnosis.code else None,
        "reason": diagnosis.reason,
        "proved": diagnosis.proof,
        "search": None,
        "shape": None,
    }
    search, violation = diagnosis.search, diagnosis.violation
    if search is not None:
        row["search"] = {
            "seeds": search.seeds,
            "branches": search.branches,
            "placements": search.placements,
            "seconds": round(search.seconds, 3),
            "said": str(search),
        }
    if violation is not None:
        path = local_name(violation.path) if violation.path else "shape"
        value, bound = finite(violation.value), finite(violation.bound)
        row |= {"quantity": path, "of": [violation.focus], "value": value, "bound": bound}
        return row | {"unit": None, "time": None, "shape": violation.shape}
    return row | _measured(diagnosis.evidence)


def _measured(evidence: Evidence | None) -> Json:
    if evidence is None:
        return dict.fromkeys(("quantity", "value", "bound", "unit", "time")) | {"of": []}
    entities = evidence.links or ((evidence.entity,) if evidence.entity else ())
    return {
        "quantity": evidence.quantity.value.replace("_", " "),
        "of": list(entities),
        "value": finite(evidence.value),
        "bound": finite(evidence.bound),
        "unit": evidence.unit,
        "time": evidence.time,
    }


def _artefact(artefact: Artefact | None) -> Json | None:
    if artefact is None:
        return None
    return {
        "kind": artefact.kind.value,
        "bytes": len(artefact.content),
        "sha256": hashlib.sha256(artefact.content).hexdigest(),
    }


def _links(stored: StoredVerdict) -> list[tuple[str, Cell]]:
    """What the verdict is about."""
    named = (("kitchen", stored.environment), ("robot", stored.robot), ("container", stored.container))
    return [(name, iri_cell(iri)) for name, iri in named if iri]


def _tee(stored: StoredVerdict) -> str | None:
    """Name of the class D that it is relative to; None for another version of one."""
    tee = tee_class_of_hash(dict(stored.inputs).get("tee_class", ""))
    return None if tee is None else tee.name


def _base(stored: StoredVerdict) -> str | None:
    """Where the base starts, if that is not the kitchen's own start."""
    start = dict(stored.inputs).get(START_INPUT, TURNED)
    return None if start.endswith(TURNED) or "," not in start else start.replace(" ", "")
