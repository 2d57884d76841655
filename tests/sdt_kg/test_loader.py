"""What reads URDF is imported without what reads meshes."""

import subprocess
import sys

READ = "from sdt_kg.load import load_twin; load_twin('b'); import sys; "


def said(code: str) -> str:
    """What a new interpreter prints."""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    return done.stdout.strip()


def test_reading_a_kitchen_imports_no_trimesh() -> None:
    assert said(READ + "print({'trimesh', 'networkx', 'scipy'} & set(sys.modules))") == "set()"
