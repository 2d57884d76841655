"""Keep verdicts as triples, ask them later, and check a certificate without the planner."""
# What was asked for is known in the answers below, which types alone do not say.
# pyright: reportArgumentType=false

from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory

from services import load
from services.embodiment.recheck import Saved, recheck_verdict
from services.store.files import SavedVerdicts, query_saved

TASK = "open:sink_area_left_middle_drawer_main"
kitchen = load("b", robots=["pr2"])

with TemporaryDirectory() as folder:
    place = Path(folder) / "verdicts.trig"  # or a directory, or the address of a SPARQL server
    with SavedVerdicts(place) as saved:
        saved.add_twin(kitchen.twin)
        for verdict in kitchen.achieve(TASK):
            saved.add(verdict)

    columns, rows = query_saved(place, "SELECT ?outcome { ?v a law:Verdict ; law:outcome ?outcome }")
    print(columns, rows)

    # The same question again: answered from where it is kept.
    with SavedVerdicts(place) as saved:
        (again,) = replace(kitchen, recall=saved.stored).achieve(TASK)
    print("stored before:", again.stored)

    # The certificate, verified by code that neither planned nor proved it.
    kept = Saved(place)
    for entry in kept.entries():
        checked = recheck_verdict(entry.stored, entry.artefact, kept.twin)
        print("holds" if checked.holds else checked.reasons, checked.about)
