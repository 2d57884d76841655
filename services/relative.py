"""The class D that a question is about: on the shell, in a message, in a case of a sweep."""

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Final, Literal

from sdt_kg.errors import InputError, UnknownEntityError
from services.dynamics.data import check_force

if TYPE_CHECKING:
    from services.app import Service

TeeName = Literal["d_artic", "d_artic_dyn"]
CLASSES: Final[dict[str, TeeName]] = {"d_artic": "d_artic", "d_artic_dyn": "d_artic_dyn"}


@dataclass(frozen=True, slots=True)
class Relative:
    """A class, and what pushes back in the kitchen where forces count.

    Attributes:
        tee: Kinematics alone, or with forces.
        forces: Turtle with force data; None: what the twin has, else what is bundled.
        handle_force: [N] Allowed at every handle instead of what the force models say.

    Raises:
        InputError: Forces for a class that knows none, or one that is no force.
    """

    tee: TeeName = "d_artic"
    forces: Path | None = None
    handle_force: float | None = None

    def __post_init__(self) -> None:
        given = {"forces": self.forces, "handle_force": self.handle_force}
        idle = [f"{name} {value}" for name, value in given.items() if value is not None]
        if idle and self.tee != "d_artic_dyn":
            raise InputError(f"{idle[0]} says nothing to {self.tee}", allowed="with tee d_artic_dyn only")
        check_force(self.handle_force)

    def of(self, service: "Service") -> "Service":
        """The service, asked relative to this class.

        Raises:
            AnnotationError: The file is no force data of the kitchen.
        """
        if self.tee == "d_artic":
            return service
        return service.with_forces(self.forces, self.handle_force)


KINEMATIC: Final = Relative()
"""D_artic."""


def tee_of(text: str) -> TeeName:
    """The class that a text names.

    Raises:
        UnknownEntityError: There is none of that name.
    """
    if text.strip().lower() not in CLASSES:
        raise UnknownEntityError("TEE class", text, CLASSES)
    return CLASSES[text.strip().lower()]


def in_class(
    service: "Service", tee: str, forces: Path | None, handle_force: float | None = None
) -> "Service":
    """The service, asked relative to that class, as `--tee`, `--forces` and `--handle-force` say.

    Raises:
        InputError: Force data, or a force, for a class without forces.
    """
    return Relative(tee_of(tee), forces, handle_force).of(service)
