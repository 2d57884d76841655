"""Which files a model may read: those of its own folder or package, or of a folder that one names."""

import os
from pathlib import Path
from typing import Final

MODELS: Final = "SDT_MODELS"
"""Variable of the folder below which models share their files, as a ROS workspace's `src` or `share`."""

WIDER: Final = f"set {MODELS} to the folder that holds all of the model's files"

PACKAGES: Final = f"packages are looked for beside the model, above it and in the folder that {MODELS} names"


def folder_of(model: Path) -> Path:
    """The folder below which all files of a model lie, links followed.

    That of `SDT_MODELS` if the model lies in it; else that of its ROS package, the nearest one above it
    with a `package.xml`; else its own.
    """
    folder, shared = model.parent.resolve(), models_folder()
    if shared is not None and folder.is_relative_to(shared):
        return shared
    return next((each for each in (folder, *folder.parents) if is_package(each)), folder)


def is_package(folder: Path) -> bool:
    """Whether it is a ROS package."""
    return (folder / "package.xml").is_file()


def models_folder() -> Path | None:
    """The folder that `SDT_MODELS` names, if it does."""
    named = os.environ.get(MODELS)
    return Path(named).resolve() if named else None
