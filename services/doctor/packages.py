"""Python, the packages that sdt needs, and its extras."""

import platform
import re
import subprocess
import sys
from collections.abc import Iterable, Iterator
from importlib.metadata import PackageNotFoundError, metadata, requires, version

from services.doctor.finding import Finding, Standing, well

DISTRIBUTION = "sdt-kg"
OLDEST_PYTHON = (3, 11)
SOLVERS = ("pin", "coal", "piqp", "numba", "numpy", "scipy")
GRAPHS = ("pyoxigraph", "rdflib", "pyshacl", "owlready2", "eclipse-zenoh")
MODULES = ("pinocchio", "coal", "piqp", "numba", "pyoxigraph", "zenoh")
"""Compiled modules, which may be installed and yet not load."""
IMPOSTORS = {"pinocchio": "pin", "shifty": "pyshifty"}
"""Packages of another thing by the import name of one that is used here, and that one."""
NOT_FOR_USERS = {"bench", "dev"}
"""Extras of those who work on sdt: no command uses them."""
_REQUIREMENT = re.compile(r"([A-Za-z0-9_.-]+)>=([0-9.]+)(?:; extra == '([a-z]+)')?")


def packages() -> Iterator[Finding]:
    """Findings about Python and every package that is declared."""
    yield _python()
    core, extras = declared()
    wrong = [said for name, least in core if (said := lacks(name, least))]
    kept = "constraints.txt has the versions that are tested"
    yield (
        well("packages", f"sdt-kg {version(DISTRIBUTION)}, and the {len(core)} packages it needs")
        if (not wrong)
        else Finding("packages", Standing.TO_DO, "; ".join(wrong), f"pip install -U {DISTRIBUTION}; {kept}")
    )
    yield well("solvers", versions(SOLVERS))
    yield well("graphs and bus", versions(GRAPHS))
    yield _loading()
    for other, meant in IMPOSTORS.items():
        if installed(other):
            yield Finding(
                f"package {other}",
                Standing.TO_DO,
                "is another thing, and hides the module that sdt needs",
                f"pip uninstall {other}; pip install --force-reinstall {meant}",
            )
    for name, needed in extras.items():
        yield of_extra(name, needed)


def declared() -> tuple[list[tuple[str, str]], dict[str, list[tuple[str, str]]]]:
    """Name and least version of what sdt-kg needs, and of what each extra needs."""
    core: list[tuple[str, str]] = []
    extras: dict[str, list[tuple[str, str]]] = {
        name: []
        for name in metadata(DISTRIBUTION).get_all("Provides-Extra") or []
        if name not in NOT_FOR_USERS
    }
    for text in requires(DISTRIBUTION) or []:
        found = _REQUIREMENT.fullmatch(text.replace('"', "'"))
        if found is None:
            continue
        name, least, extra = found.groups()
        if extra is None:
            core.append((name, least))
        elif extra in extras:
            extras[extra].append((name, least))
    return core, extras


def installed(name: str) -> str | None:
    """The version that is installed."""
    try:
        return version(name)
    except PackageNotFoundError:
        return None


def lacks(name: str, least: str) -> str:
    """What is wrong with a package; empty if nothing is."""
    there = installed(name)
    if there is None:
        return f"{name} is missing"
    return "" if numbers(there) >= numbers(least) else f"{name} {there} is older than {least}"


def numbers(text: str) -> tuple[int, ...]:
    """`(1, 26)` of `1.26.0rc1`: the numbers in front, without zeros at their end."""
    found = [int(each) for each in re.match(r"[0-9.]*", text)[0].split(".") if each]  # pyright: ignore[reportOptionalSubscript]  # matches anything
    while found and not found[-1]:
        found.pop()
    return tuple(found)


def versions(names: Iterable[str]) -> str:
    """Each with its version."""
    return ", ".join(f"{name} {installed(name) or 'missing'}" for name in names)


def _python() -> Finding:
    says = f"{platform.python_implementation()} {platform.python_version()}, {sys.executable}"
    if sys.version_info >= OLDEST_PYTHON:
        return well("python", says)
    return Finding("python", Standing.TO_DO, says, "sdt needs Python 3.11 or newer")


def _loading() -> Finding:
    """Whether compiled modules load, asked of a fresh process, which a crash cannot take along."""
    script = "import importlib, sys\nfor name in sys.argv[1:]: importlib.import_module(name)"
    done = subprocess.run(  # noqa: S603 - our own words
        [sys.executable, "-c", script, *MODULES], capture_output=True, text=True, check=False
    )
    if done.returncode == 0:
        return well("compiled modules", f"{', '.join(MODULES)} load")
    last = (done.stderr.strip().splitlines() or [f"ended with {done.returncode}"])[-1]
    return Finding(
        "compiled modules",
        Standing.TO_DO,
        last,
        "install with pip into a virtual environment (not --target, and without PYTHONPATH)",
    )


def of_extra(name: str, needed: list[tuple[str, str]]) -> Finding:
    """Whether an extra is there; that it is not is no reason to do anything."""
    wrong = [said for package, least in needed if (said := lacks(package, least))]
    if not wrong:
        return well(f"extra {name}", versions(package for package, _ in needed))
    return Finding(
        f"extra {name}", Standing.OPTIONAL, "; ".join(wrong), f"pip install '{DISTRIBUTION}[{name}]'"
    )
