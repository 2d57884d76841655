"""Φ lets no drawer or door through a box, wherever it stands, and stops none without one: 2,500 cabinets."""

from pathlib import Path

from tests.soak.cabinets import BEYOND, asked, deepest, passed_through, random_cabinet

CABINETS = 2500


def test_no_container_passes_through_what_is_in_its_way(tmp_path: Path) -> None:
    judged(range(CABINETS), tmp_path)


def judged(seeds: range, tmp_path: Path) -> None:
    """Each cabinet by itself; some are stopped, and some are free."""
    stopped = 0
    for seed in seeds:
        cabinet = random_cabinet(seed)
        block = asked(cabinet, tmp_path / "random.urdf")
        end = cabinet.upper if block is None else block.position
        assert passed_through(cabinet, end) <= BEYOND, f"cabinet {seed} lets it through"
        if block is not None:
            assert deepest(cabinet, block.position) >= block.allowed - 1e-4, f"cabinet {seed} stops it"
            stopped += 1
    assert len(seeds) / 5 < stopped < len(seeds) * 4 / 5
