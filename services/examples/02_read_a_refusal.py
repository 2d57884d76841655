"""Why not? A refusal names every reason, with what was measured, and says whether it is proved."""

from sdt_kg.annotation import Drive
from services import load
from services.app import Policy

kitchen = load("b", robots=["pr2"], policy=Policy(drive=Drive.FIXED))  # it must not drive
(verdict,) = kitchen.achieve("open:iai_fridge_door")
print(verdict.outcome.value)

for diagnosis in verdict.diagnoses:
    print(f"{diagnosis.kind.value}: {diagnosis.reason}")
    if diagnosis.evidence:
        print(f"  {diagnosis.evidence.quantity.value} {diagnosis.evidence.value:g} {diagnosis.evidence.unit}")
    # A search that gave up denies nothing. A proof denies, relative to D_artic.
    print("  proved" if diagnosis.proof else f"  {diagnosis.search}")

# Three other ways to hear no, or nothing at all:
already = kitchen.at("iai_fridge_door=open")
(answer,) = already.causes("open:iai_fridge_door")
print(f"{answer.diagnoses[0].kind.value}: {answer.diagnoses[0].reason}")

blocked = load("a").causes("open:dishwasher_drawer_middle")  # behind a closed door
print("; ".join(each.reason for answer in blocked for each in answer.diagnoses))
