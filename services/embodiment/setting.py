"""What is asked of a whole body, and under which policy."""

from dataclasses import dataclass

from sdt_kg.annotation import Drive
from sdt_kg.iri import Iri
from sdt_kg.motion import Motion
from sdt_kg.twin import Container
from services.embodiment.body.world import World
from services.embodiment.certify.tolerances import Tolerances
from services.embodiment.hold.kit import Kits
from services.embodiment.ways.roads import Known


@dataclass(frozen=True, slots=True, eq=False)
class Setting:
    """What is asked, and under which policy."""

    world: World
    container: Container
    motion: Motion
    drive: Drive
    start: tuple[float, float, float]
    robot: Iri
    kits: Kits
    roads: Known
    tolerances: Tolerances
