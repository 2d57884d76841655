"""Java, compiled loops, memory, disk."""

import os
import re
import shutil
import tempfile
from collections.abc import Iterator
from importlib import import_module
from pathlib import Path

import services
from services.doctor.finding import Finding, Standing, well
from services.kernel import is_kernel, kept

LEAST_MEMORY = 1.0
"""[GB] A worker process with a kitchen and a robot takes about 0.4 GB (measured: resident, kitchen a)."""
LEAST_DISK = 0.5
"""[GB] A table of 132 verdicts takes about 0.05 GB with certificates; the rest is for temporary files."""
GB = 1e9
LATER = (
    "services.dynamics.",
    "services.physics.geometry.deepest",
    "services.physics.geometry.fans",
    "services.physics.geometry.pieces",
    "services.reports.",
)
"""Modules with loops that no first question about bundled models needs: of forces, new meshes and reports."""
_DECLARES = re.compile(r"^from services\.kernel import (\w+, )*kernel\b", re.MULTILINE)


def machine() -> Iterator[Finding]:
    """Findings about what is outside Python."""
    yield _java()
    yield _kernels()
    free = free_memory()
    if free is not None:
        yield memory(free)
    for place in dict.fromkeys((Path.cwd(), Path(tempfile.gettempdir()))):
        yield _disk(place)


def free_memory() -> float | None:
    """[GB] What this process may still take, a container's limit minded; None where it is not told."""
    told = Path("/proc/meminfo")
    if not told.is_file():
        return None
    rows = dict(line.split(":", 1) for line in told.read_text().splitlines() if ":" in line)
    free = float(rows["MemAvailable"].split()[0]) * 1024 / GB
    limit, used = (Path("/sys/fs/cgroup") / f"memory.{name}" for name in ("max", "current"))
    if limit.is_file() and used.is_file() and limit.read_text().strip() != "max":
        free = min(free, (float(limit.read_text()) - float(used.read_text())) / GB)
    return free


def memory(free: float) -> Finding:
    """Whether so much [GB] is enough."""
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    says = f"{free:.1f} GB free, {cores} cores"
    if free >= LEAST_MEMORY:
        return well("memory", says)
    remedy = "fewer worker processes (--jobs 1), or end other programs"
    return Finding("memory", Standing.TO_DO, says, remedy)


def _java() -> Finding:
    found = shutil.which("java")
    if found:
        return well("java", f"{found}: sdt reason decides OWL 2 DL (HermiT)")
    return Finding(
        "java",
        Standing.OPTIONAL,
        "not there: sdt reason uses OWL 2 RL, which misses some contradictions",
        "install a Java runtime, version 17 say, for HermiT",
    )


def _kernels() -> Finding:
    """Whether inner loops are compiled already."""
    root = Path(str(services.__file__)).parent
    modules = [
        ".".join(path.relative_to(root.parent).with_suffix("").parts)
        for path in root.rglob("*.py")
        if _DECLARES.search(path.read_text(encoding="utf-8"))
    ]
    missing = [module for module in modules if not _compiled(module)]
    says = f"{len(modules) - len(missing)} of {len(modules)} modules with loops are compiled and kept"
    if not missing:
        return well("compiled loops", says)
    if all(module.startswith(LATER) for module in missing):
        return well("compiled loops", f"{says}; those of forces, new meshes and reports when first needed")
    return Finding(
        "compiled loops",
        Standing.OPTIONAL,
        f"{says}: the first question that needs another waits for it, up to a minute or two",
        "sdt achieve --kitchen b --robot pr2 --task open:sink_area_left_middle_drawer_main, and for those of "
        "proofs sdt achieve --kitchen b --robot stretch --drive fixed --task open:iai_fridge_door, once",
    )


def _compiled(module: str) -> bool:
    """Whether something is kept of a module's loops as they are now."""
    own = (each for each in vars(import_module(module)).values() if getattr(each, "__module__", "") == module)
    return any(kept(each) for each in own if is_kernel(each))


def _disk(place: Path) -> Finding:
    free, about = shutil.disk_usage(place).free / GB, f"disk {place}"
    says = f"{free:.1f} GB free" + ("" if os.access(place, os.W_OK) else ", and not writable")
    if free >= LEAST_DISK and os.access(place, os.W_OK):
        return well(about, says)
    return Finding(
        about, Standing.TO_DO, says, "make room, or work in another folder (TMPDIR for temporary files)"
    )
