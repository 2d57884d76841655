"""The same question in another world: another twin, another robot, another task (mode 4)."""

from predicates.counterfactual import Contrast
from sdt_kg.annotation import Drive
from services import load
from services.app import Policy, Service

TASK = "open:sink_area_left_middle_drawer_main"
kitchen = load("b", robots=["pr2"])


def judged(service: Service):  # noqa: ANN201 - one verdict
    """The one verdict on the task."""
    (verdict,) = service.achieve(TASK)
    return verdict


actual = judged(kitchen)

# What if the drawer's track ended after 20 cm? Every edit makes another twin; rules run again.
drawer = kitchen.twin.container("sink_area_left_middle_drawer_main")
shorter = Service(kitchen.twin.with_edit(drawer.joint, upperLimit=0.2))
# What if it had to be done without driving, a metre further back?
elsewhere = load("b", robots=["pr2"], policy=Policy(drive=Drive.FIXED, base=(-1.0, 0.0, 0.0)))

for name, other in (("shorter drawer", shorter), ("from elsewhere", elsewhere)):
    contrast = Contrast(actual, judged(other))
    print(f"{name}: {contrast.counterfactual.outcome.value}", "turned" if contrast.turned else "stays")
    for predicate, before, after in contrast.turned_predicates():
        print(f"  {predicate}: {before} -> {after}")
