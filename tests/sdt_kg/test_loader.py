"""What reads URDF is imported without what reads meshes, and who imports that has all of it."""

import subprocess
import sys

READ = "from sdt_kg.load import load_twin; load_twin('b'); import sys; "


def said(code: str) -> str:
    """What a new interpreter prints."""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    return done.stdout.strip()


def test_reading_a_kitchen_imports_no_trimesh() -> None:
    assert said(READ + "print({'trimesh', 'networkx', 'scipy'} & set(sys.modules))") == "set()"


def test_trimesh_is_whole_for_who_imports_it_later_and_for_yourdfpy_itself() -> None:
    later = "import trimesh, yourdfpy; box = yourdfpy.urdf.trimesh.creation.box((1, 2, 3)); "
    shown = (
        "print(isinstance(box, trimesh.Trimesh), box.volume, len(yourdfpy.urdf.trimesh.Scene(box).geometry))"
    )
    assert said(READ + later + shown) == "True 6.0 1"
