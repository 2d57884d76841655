"""The kitchen is a graph: ask it in SPARQL, and ask which requests a state meets."""
# What was asked for is known in the answers below, which types alone do not say.
# pyright: reportArgumentType=false, reportAttributeAccessIssue=false

from sdt_kg.iri import local_name
from services import load

kitchen = load("b")
columns, rows = kitchen.query("""
    SELECT ?door ?joint ?upper {
      ?door a sdt:Door ; sdt:hasJoint ?joint .
      ?joint sdt:upperLimit ?upper .
    } ORDER BY ?upper""")
for row in rows:
    print(local_name(str(row["door"])), row["upper"], "rad")

# States are branches: the entities are shared, nothing is copied, nothing is changed.
ajar = kitchen.at("iai_fridge_door=1.2")
wide = kitchen.at("iai_fridge_door=open")
for name, state in (("ajar", ajar), ("wide", wide)):
    met = [answer.case.task for answer in state.satisfies() if answer.case.task.verb.value == "open"]
    print(name, "meets", [str(task) for task in met])

# Where 'open' begins is Eq. (8): 90 % of the upper limit.
door = kitchen.twin.container("iai_fridge_door")
print(f"open from {door.open_from:.4f} rad, closed up to {door.closed_to:.2f} rad")
