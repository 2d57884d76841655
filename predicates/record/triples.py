"""Verdicts → triples: PROV-O and law:, in a named graph for each verdict."""

from collections.abc import Iterator
from dataclasses import dataclass

import pyoxigraph as ox

from predicates.case import Case, Diagnosis, Evidence, Verdict
from predicates.meant import containers_meant, left_parked
from predicates.record.artefacts import artefact_triples
from predicates.record.explained import allowance_triples, answer_triples, position_triples, scope_triples
from predicates.record.inputs import Inputs
from predicates.record.recall import budget_of
from predicates.record.report import answers, drive, figures, gripper, nearest_pairs, notes, tee_class
from predicates.record.seal import SECONDS, sealed
from predicates.record.stored import DIAGNOSIS_CLASS, OUTCOME_TERM
from predicates.scope import verb_iri
from sdt_kg.iri import LAW, PROV, RDF, Iri, graph_iri, local_name, part_iri
from sdt_kg.motion import BodyMotion, Motion
from sdt_kg.state import Region
from sdt_kg.store import Term, Triple
from sdt_kg.task import Task


@dataclass(frozen=True, slots=True)
class Record:
    """A verdict's triples, in a named graph of their own.

    Attributes:
        verdict: IRI of the verdict.
        graph: IRI of its named graph.
        triples: Subject, predicate, object.
    """

    verdict: Iri
    graph: Iri
    triples: tuple[Triple, ...]

    def quads(self) -> Iterator[ox.Quad]:
        """The triples with their graph."""
        name = ox.NamedNode(self.graph)
        for subject, predicate, value in self.triples:
            yield ox.Quad(ox.NamedNode(subject), ox.NamedNode(predicate), value, name)


def to_record(verdict: Verdict) -> Record:
    """The verdict as PROV-O and law: triples, no blank nodes."""
    key = local_name(verdict.iri)
    twin = verdict.case.twin
    began = (
        *position_triples(verdict.iri, twin.entities.coupling.start(), twin.state),
        *allowance_triples(verdict.iri, twin),
    )
    explained = (*answer_triples(verdict), *scope_triples(verdict), *began)
    explained = (*explained, *artefact_triples(verdict))
    triples = (
        *_verdict(verdict),
        *_case(verdict),
        *provenance_triples(verdict.iri, verdict.inputs),
        *explained,
    )
    return Record(verdict.iri, graph_iri("verdict", key), sealed(verdict.iri, triples))


def write(store: ox.Store, record: Record) -> bool:
    """Whether the store has changed: a verdict that is there already stays, unless it gives way."""
    graph = ox.NamedNode(record.graph)
    if store.contains_named_graph(graph):
        if not gives_way(list(store.quads_for_pattern(None, None, None, graph)), list(record.quads())):
            return False
        store.remove_graph(graph)
    store.extend(record.quads())
    return True


def gives_way(stored: list[ox.Quad], fresh: list[ox.Quad]) -> bool:
    """Whether the stored record of a verdict is to be replaced by this one.

    It is only if it is a refusal without proof, and then by a later answer of a search that was allowed
    at least as long, or that found more: it was searched, and a longer search may find what a shorter
    one did not.
    """
    shorter = _searched(fresh) and _budget(fresh) < _budget(stored)
    return _searched(stored) and not shorter and not _same_claims(stored, fresh)


def _verdict(verdict: Verdict) -> Iterator[Triple]:
    """Outcome, the three answers, diagnoses, figures."""
    subject = verdict.iri
    yield subject, RDF + "type", _node(LAW + "Verdict")
    yield subject, LAW + "outcome", _node(LAW + OUTCOME_TERM[verdict.outcome])
    for name, answer in answers(verdict).items():
        if answer is not None:
            yield subject, LAW + name, _literal(answer.holds)
    yield subject, LAW + "seconds", _literal(verdict.seconds)
    for name, value in (("gripper", gripper(verdict)), ("drive", drive(verdict))):
        if value is not None:
            yield subject, LAW + name, _literal(value)
    for note in notes(verdict):
        yield subject, LAW + "note", _literal(note)
    for index, diagnosis in enumerate(verdict.diagnoses, 1):
        of = part_iri(verdict.iri, "diagnosis", index)
        yield subject, LAW + "diagnosis", _node(of)
        yield from diagnosis_triples(of, diagnosis)
    yield from _figures(verdict)


def _figures(verdict: Verdict) -> Iterator[Triple]:
    """Margins; of a smallest distance that was measured also between which two bodies it is, and when."""
    subject, pairs = verdict.iri, nearest_pairs(verdict)
    for index, (name, (value, unit)) in enumerate(sorted(figures(verdict).items()), 1):
        of = part_iri(verdict.iri, "figure", index)
        yield subject, LAW + "figure", _node(of)
        yield of, RDF + "type", _node(LAW + "Figure")
        yield of, LAW + "name", _literal(name)
        yield of, LAW + "value", _literal(value)
        yield of, LAW + "unit", _literal(unit)
        if (pair := pairs.get(name)) is not None:
            yield of, LAW + "time", _literal(pair.time)
            for link in pair.links:
                yield of, LAW + "link", _node(link)


def diagnosis_triples(of: Iri, diagnosis: Diagnosis) -> Iterator[Triple]:
    """A reason as the individual `of`: kind, sentence, whether proved, what was measured or searched."""
    yield of, RDF + "type", _node(LAW + DIAGNOSIS_CLASS[diagnosis.kind])
    yield of, LAW + "reason", _literal(diagnosis.reason)
    if diagnosis.code is not None:
        yield of, LAW + "code", _literal(diagnosis.code.value)
    yield of, LAW + "proof", _literal(diagnosis.proof)
    if diagnosis.evidence is not None:
        yield from _evidence(of, diagnosis.evidence)
    if diagnosis.search is not None:
        for name in ("seeds", "branches", "placements", "seconds"):
            yield of, LAW + f"searched{name.capitalize()}", _literal(getattr(diagnosis.search, name))


def _evidence(of: Iri, evidence: Evidence) -> Iterator[Triple]:
    yield of, LAW + "quantity", _literal(evidence.quantity.value)
    yield of, LAW + "value", _literal(evidence.value)
    yield of, LAW + "bound", _literal(evidence.bound)
    yield of, LAW + "unit", _literal(evidence.unit)
    if evidence.time is not None:
        yield of, LAW + "time", _literal(evidence.time)
    if evidence.scope:
        yield of, LAW + "collisionScope", _literal(evidence.scope)
    if evidence.path is not None:
        yield of, LAW + "path", _node(evidence.path)
    if evidence.entity is not None:
        yield of, LAW + "entity", _node(evidence.entity)
    for link in evidence.links or ():
        yield of, LAW + "link", _node(link)


def _case(verdict: Verdict) -> Iterator[Triple]:
    """What was asked, and what was solved for."""
    subject, case = verdict.iri, verdict.case
    yield subject, LAW + "environment", _node(case.twin.environment)
    if (tee := tee_class(verdict)) is not None:
        yield subject, LAW + "teeClass", _node(tee.iri)
    if isinstance(case.robot, str):
        yield subject, LAW + "robot", _node(case.robot)
    if isinstance(case.task, Task):
        task = part_iri(verdict.iri, "task", 1)
        yield subject, LAW + "task", _node(task)
        yield task, RDF + "type", _node(LAW + "Task")
        yield task, LAW + "verb", _node(verb_iri(case.task.verb))
        if isinstance(case.task.container, str):
            yield subject, LAW + "container", _node(case.task.container)
            yield task, LAW + "container", _node(case.task.container)
    elif (container := _meant(case)) is not None:
        yield subject, LAW + "container", _node(container)
    if isinstance(case.motion, Motion):
        yield from _motion(verdict.iri, case.motion)
    if isinstance(case.body_motion, BodyMotion):
        yield from _body_motion(verdict.iri, case, case.body_motion)


def _meant(case: Case) -> Iri | None:
    """The one container that a case without a task is about: that of its goal, else that of its motion."""
    if isinstance(case.final, Region):
        joints = {joint for joint, _ in case.final.intervals}
        found = [each.iri for each in case.twin.containers() if each.joint in joints]
    else:
        found = [each.iri for each in containers_meant(case)] if isinstance(case.motion, Motion) else []
    return found[0] if len(found) == 1 else None


def _motion(verdict: Iri, motion: Motion) -> Iterator[Triple]:
    """Summary of τ; the samples are kept beside the graph."""
    of = part_iri(verdict, "motion", 1)
    yield verdict, LAW + "motion", _node(of)
    yield of, RDF + "type", _node(LAW + "Motion")
    yield of, LAW + "entity", _node(motion.of)
    yield of, LAW + "duration", _literal(float(motion.times[-1] - motion.times[0]))
    if not motion.is_poses:
        yield of, LAW + "startPosition", _literal(float(motion.values[0, 0]))
        yield of, LAW + "endPosition", _literal(float(motion.values[-1, 0]))


def _body_motion(verdict: Iri, case: Case, motion: BodyMotion) -> Iterator[Triple]:
    """Summary of Γ, and what it leaves parked; the samples are kept beside the graph."""
    of = part_iri(verdict, "body_motion", 1)
    yield verdict, LAW + "bodyMotion", _node(of)
    yield of, RDF + "type", _node(LAW + "BodyMotion")
    yield of, LAW + "duration", _literal(float(motion.times[-1] - motion.times[0]))
    yield of, LAW + "samples", _literal(len(motion.times))
    for joint in left_parked(case):
        yield of, LAW + "leavesParked", _node(joint)


def provenance_triples(judged: Iri, inputs: Inputs) -> Iterator[Triple]:
    """PROV-O: the judging used these inputs."""
    activity = part_iri(judged, "judging", 1)
    yield judged, PROV + "wasGeneratedBy", _node(activity)
    yield activity, RDF + "type", _node(PROV + "Activity")
    for index, (name, value) in enumerate(inputs, 1):
        of = part_iri(judged, "input", index)
        yield activity, PROV + "used", _node(of)
        yield of, RDF + "type", _node(LAW + "Input")
        yield of, LAW + "name", _literal(name)
        yield of, LAW + "inputHash", _literal(value)


def _searched(quads: list[ox.Quad]) -> bool:
    """Whether the verdict is a refusal that rests on a search alone."""
    claims = {(quad.predicate, quad.object) for quad in quads}
    refused = (ox.NamedNode(LAW + "outcome"), ox.NamedNode(LAW + "NotCertified")) in claims
    return refused and (ox.NamedNode(LAW + "proof"), ox.Literal(True)) not in claims


def _budget(quads: list[ox.Quad]) -> float:
    """[s] Seconds that the search was allowed; infinite where it had no bound."""
    texts: dict[str, dict[str, str]] = {}
    for quad in quads:
        if isinstance(quad.subject, ox.NamedNode) and isinstance(quad.object, ox.Literal):
            texts.setdefault(quad.subject.value, {})[quad.predicate.value] = quad.object.value
    inputs = [each for each in texts.values() if LAW + "inputHash" in each]
    return budget_of(tuple((each[LAW + "name"], each[LAW + "inputHash"]) for each in inputs))


def _same_claims(stored: list[ox.Quad], fresh: list[ox.Quad]) -> bool:
    """Whether two records of a verdict differ in nothing but seconds."""
    before = {(quad.subject, quad.predicate, quad.object) for quad in stored}
    after = {(quad.subject, quad.predicate, quad.object) for quad in fresh}
    return all(predicate.value in SECONDS for _, predicate, _ in before ^ after)


def _node(iri: Iri) -> Term:
    return ox.NamedNode(iri)


def _literal(value: str | float | bool) -> Term:
    """bool, int, float or text as a literal of its own datatype; doubles round-trip."""
    return ox.Literal(value)
