"""Names that a shell completes: bundled models, containers and joints of a kitchen's twin."""

import contextlib
import hashlib
import json
import os
from importlib.metadata import version
from pathlib import Path
from typing import Final

import kitchens
import robots
from sdt_kg.errors import SdtError

KINDS: Final = {"kitchen": kitchens.path, "robot": robots.path}

Names = dict[str, list[str]]


def bundled(kind: str) -> list[str]:
    """Bundled models of a kind."""
    return sorted(each.parent.name for each in KINDS[kind]("").glob("*/*.urdf"))


def first_kitchen(words: list[str]) -> str | None:
    """The first word that is a bundled kitchen, or a file."""
    return next((word for word in words if word in bundled("kitchen") or Path(word).is_file()), None)


def names_of(kitchen: str) -> Names:
    """Containers and joints of a kitchen; none where it cannot be read, since nobody asked for an error.

    Loading a twin takes seconds, so names are kept in the user's cache until the model changes.
    """
    bundled_path = kitchens.path(kitchen) / f"{kitchen}.urdf" if "/" not in kitchen else Path(kitchen)
    path = bundled_path if bundled_path.is_file() else Path(kitchen)
    if not path.is_file():
        return {"containers": [], "joints": []}
    kept = _kept(path)
    with contextlib.suppress(OSError, ValueError):
        return json.loads(kept.read_text(encoding="utf-8"))
    found = _read(kitchen)
    with contextlib.suppress(OSError):  # a home that cannot be written costs seconds, not the answer
        kept.parent.mkdir(parents=True, exist_ok=True)
        kept.write_text(json.dumps(found), encoding="utf-8")
    return found


def _kept(path: Path) -> Path:
    """Where the names of this content of the model are kept."""
    home = os.environ.get("XDG_CACHE_HOME") or Path("~/.cache").expanduser()
    files = [each for each in (path, path.with_suffix(".ttl")) if each.is_file()]
    stamps = [f"{each.resolve()} {each.stat().st_mtime_ns} {each.stat().st_size}" for each in files]
    key = hashlib.sha256("\n".join([version("sdt-kg"), *stamps]).encode()).hexdigest()
    return Path(home) / "sdt" / "names" / f"{key[:32]}.json"


def _read(kitchen: str) -> Names:
    from sdt_kg.iri import local_name  # noqa: PLC0415 - most completions need no twin
    from sdt_kg.load import load_twin  # noqa: PLC0415 - see above

    try:
        twin = load_twin(kitchen)
    except SdtError:
        return {"containers": [], "joints": []}
    containers = twin.containers()
    joints = dict.fromkeys(
        local_name(joint) for each in containers for joint in (each.joint, each.active_joint)
    )
    return {"containers": [each.name for each in containers], "joints": list(joints)}
