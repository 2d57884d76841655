"""Which files an MJCF scene has MuJoCo read, before it does."""

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Final
from xml.etree import ElementTree as ET

from sdt_kg.errors import UrdfError
from sdt_kg.urdf.document import refuse_unsafe
from sdt_kg.urdf.folder import WIDER

FOLDERS: Final = ("meshdir", "texturedir", "assetdir")
SEARCHED: Final = {"mesh": ("meshdir", "assetdir"), "texture": ("texturedir", "assetdir"), "include": ()}
"""Element → which folders MuJoCo may look for its file in; where none is named, in the scene's."""


def check_files(root: ET.Element, scene: Path, folder: Path, seen: tuple[Path, ...] = ()) -> None:
    """That all files, those of what is included and attached too, lie in a folder.

    Args:
        root: Of the scene's document.
        scene: Its file.
        folder: In which they have to lie.
        seen: Scenes to which it is attached.

    Raises:
        UrdfError: One lies elsewhere, or is no XML.
    """
    files = _included(root, scene, folder)
    named = _folders(files, scene, folder)
    for path, tree in files.items():
        for element in tree.iterfind(".//*[@file]"):
            starts = [place for each in SEARCHED.get(element.tag, FOLDERS) for place in named[each]]
            attached = _inside(element, "file", path, starts or [scene.parent], folder)
            if element.tag == "model" and attached.is_file() and attached not in seen:
                check_files(_tree(attached), attached, folder, (*seen, attached))


def _included(root: ET.Element, scene: Path, folder: Path) -> dict[Path, ET.Element]:
    """The scene and what it includes; MuJoCo finds all of it from the scene's folder."""
    files, waiting = {scene: root}, [scene]
    while waiting:
        path = waiting.pop()
        for element in files[path].iter("include"):
            included = _inside(element, "file", path, [scene.parent], folder)
            if included.is_file() and included not in files:
                files[included] = _tree(included)
                waiting.append(included)
    return files


def _folders(files: Mapping[Path, ET.Element], scene: Path, folder: Path) -> dict[str, list[Path]]:
    """Where the compiler is told to look for meshes, textures and either, by any of the files."""

    def places(attribute: str) -> Iterator[Path]:
        for path, tree in files.items():
            for element in tree.iterfind(f".//compiler[@{attribute}]"):
                yield _inside(element, attribute, path, [scene.parent], folder)

    return {each: list(places(each)) for each in FOLDERS}


def _inside(element: ET.Element, attribute: str, path: Path, starts: list[Path], folder: Path) -> Path:
    """Where the file or folder that an attribute names is, from the first of several starts.

    Raises:
        UrdfError: From one of them it is outside of a folder.
    """
    text = element.get(attribute, "")
    places = [(start / text).resolve() for start in starts]
    if not all(each.is_relative_to(folder) for each in places):
        raise UrdfError(
            f"{path}: {attribute}='{text}' lies outside of '{folder}'",
            allowed="files below that folder",
            remedy=WIDER,
        )
    return places[0]


def _tree(path: Path) -> ET.Element:
    content = path.read_bytes()
    refuse_unsafe(content, path)
    return ET.fromstring(content)  # noqa: S314 - no DTD is left in the text
