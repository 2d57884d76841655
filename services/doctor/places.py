"""Models, settings, stores, and who answers on the bus."""

import shlex
from collections.abc import Iterator, Sequence
from pathlib import Path

import kitchens
import robots
from sdt_kg.errors import InputError, SdtError
from sdt_kg.load import load_twin
from sdt_kg.numbers import so_many
from sdt_kg.scope import violations
from services.doctor.finding import Finding, Standing, well

COUNT = "SELECT (COUNT(?v) AS ?verdicts) { ?v a law:Verdict }"


def models(kitchen_names: Sequence[str], robot_names: Sequence[str]) -> Iterator[Finding]:
    """Every bundled model, and those named, is loaded, and judged by the shapes of D_artic.

    Of those named, what loading changed, chose or assumed is told as well: bundled ones are known.
    """
    everyone = [*_bundled(robots.path("")), *robot_names]
    for name in dict.fromkeys([*_bundled(kitchens.path("")), *kitchen_names]):
        yield _kitchen(name, noted=name in kitchen_names)
    for name in dict.fromkeys(everyone):
        yield _robot(name, noted=name in robot_names)


def _bundled(folder: Path) -> list[str]:
    return sorted(each.parent.name for each in folder.glob("*/*.urdf"))


def _kitchen(name: str, *, noted: bool) -> Finding:
    about = f"kitchen {name}"
    try:
        twin = load_twin(name)
        containers = twin.containers()
        outside = [each.name for each in containers if violations(twin, each, None)]
    except SdtError as error:
        return Finding(about, Standing.TO_DO, str(error), f"sdt containers {name} says the same")
    inside = f"{len(containers) - len(outside)} in scope of D_artic"
    says = f"{so_many(len(containers), 'container', 'containers')}, {inside}"
    notes = twin.notes if noted else ()
    if not containers:
        remedy = f"sdt containers {name} --all says what is left out, and why"
        return Finding(about, Standing.TO_DO, says, remedy, notes)
    if outside:
        return Finding(about, Standing.TO_DO, says, f"sdt scope {name} says where not", notes)
    return well(about, says, notes)


def _robot(name: str, *, noted: bool) -> Finding:
    about = f"robot {name}"
    try:
        twin = load_twin("b", [name])
    except SdtError as error:
        return Finding(
            about,
            Standing.TO_DO,
            str(error),
            f"sdt robot describe {shlex.quote(name)} writes a first annotation",
        )
    grippers = len(twin.robot(twin.robots[0]).grippers)
    own = f"{twin.name(twin.robots[0])}: "
    notes = tuple(note for note in twin.notes if note.startswith(own)) if noted else ()
    return well(about, f"annotated, {so_many(grippers, 'gripper', 'grippers')}", notes)


def stores(places: Sequence[str]) -> Iterator[Finding]:
    """Whether each can be read, and how many verdicts are in it."""
    from services.store.files import is_saved_graph, query_saved  # noqa: PLC0415 - most need no store

    for place in places:
        about = f"store {place}"
        if not is_saved_graph(place):
            says = (
                "no store: allowed FILE.trig, FILE.nq, a directory that --save made, the address of a server"
            )
            yield Finding(about, Standing.TO_DO, says, "sdt achieve … --save makes one")
            continue
        try:
            _, rows = query_saved(place, COUNT)
        except InputError as error:
            yield Finding(about, Standing.TO_DO, str(error), "sdt achieve … --save makes it")
        except SdtError as error:
            yield Finding(about, Standing.TO_DO, str(error), "end the other process, or start the server")
        else:
            yield well(about, so_many(int(str(rows[0]["verdicts"])), "verdict", "verdicts"))


def bus(endpoint: str, config: Path | None, kitchen_names: Sequence[str]) -> Iterator[Finding]:
    """Whether anybody listens there, which oracles answer, and which servers have these kitchens."""
    from services.bus.keys import Oracle, any_live, any_oracle  # noqa: PLC0415 - most need no bus
    from services.bus.sessions import open_session  # noqa: PLC0415 - see above

    about = f"bus {endpoint}"
    try:
        session = open_session(connect=endpoint, mode="client", config=config)
    except SdtError as error:
        yield Finding(
            about, Standing.TO_DO, str(error), "sdt router --listen …, or sdt serve --kitchen … --bus …"
        )
        return
    with session:
        yield well(about, "reached")
        expressions = {f"oracle {kind.value}": any_oracle(kind) for kind in Oracle}
        expressions |= {f"server of {name}": any_live(Path(name).stem) for name in kitchen_names}
        for who, expression in expressions.items():
            found = [reply for reply in session.liveliness().get(expression, timeout=1.0) if reply.ok]
            if found:
                yield well(f"{who}", f"{len(found)} there")
            else:
                start = f"sdt {who}" if who.startswith("oracle") else "sdt serve --kitchen … --bus …"
                how = (
                    f"{start} starts one" if not who.startswith("oracle") else f"{start} --connect {endpoint}"
                )
                yield Finding(who, Standing.OPTIONAL, "nobody there", how)
