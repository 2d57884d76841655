"""Can the PR2 open a drawer of kitchen B?"""
# What was asked for is known in the answers below, which types alone do not say.
# pyright: reportOptionalMemberAccess=false

from services import load

kitchen = load("b", robots=["pr2"])
(verdict,) = kitchen.achieve("open:sink_area_left_middle_drawer_main")
print(verdict.outcome.value)

# A verdict is three answers. None would mean that a predicate was not asked.
for name in ("satisfies_request", "causes", "can_perform"):
    answer = getattr(verdict, name)
    print(f"  {name}: {answer.holds}")

# What the certificate promises, in figures with their units. Smallest distances are looked at up to 0.02 m:
# just this says that nothing was found nearer.
for name, (value, unit) in verdict.can_perform.figures.items():
    print(f"  {name}: {value:.4g} {unit}")

# The name of the verdict is a hash of all that was asked: the same question has the same name.
print(verdict.iri)
