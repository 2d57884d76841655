"""Archives of arrays are bounded before they are unpacked, and say a thing once."""

import zipfile
from pathlib import Path

import numpy as np
import pytest

from services.motions import archive
from services.motions.archive import arrays_in


def test_arrays_are_read_by_name(tmp_path: Path) -> None:
    np.savez_compressed(tmp_path / "a.npz", times=np.arange(3.0))
    assert arrays_in(tmp_path / "a.npz")["times"].tolist() == [0, 1, 2]


def test_what_is_small_only_as_long_as_it_is_packed_is_not_unpacked(tmp_path: Path) -> None:
    bomb, zeros = tmp_path / "bomb.npz", b"\0" * 2**24
    with zipfile.ZipFile(bomb, "w", zipfile.ZIP_DEFLATED) as packed, packed.open("times.npy", "w") as file:
        for _ in range(archive.MOST // len(zeros) + 1):
            file.write(zeros)
    assert bomb.stat().st_size < 2**20
    with pytest.raises(ValueError, match="they would have 553648128 bytes, and 536870912 at most"):
        arrays_in(bomb)


@pytest.mark.filterwarnings("ignore:Duplicate name")
def test_an_array_that_is_there_twice_is_refused(tmp_path: Path) -> None:
    np.savez(tmp_path / "a.npz", times=np.arange(3.0))
    with zipfile.ZipFile(tmp_path / "a.npz", "a") as packed:
        packed.writestr("times.npy", packed.read("times.npy"))
    with pytest.raises(ValueError, match="'times' is there twice"):
        arrays_in(tmp_path / "a.npz")
