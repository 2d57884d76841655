"""Two figures in a sentence are told with so many digits that one can see which is larger."""

import pytest

from sdt_kg.numbers import told_apart


@pytest.mark.parametrize(
    ("value", "bound", "digits", "form", "told"),
    [
        (70.04, 70.0, 1, "f", ("70.04", "70.00")),
        (71.0, 70.0, 1, "f", ("71.0", "70.0")),
        (0.50002, 0.5, 4, "g", ("0.50002", "0.5")),
        (0.6, 0.5, 4, "g", ("0.6", "0.5")),
        (0.5, 0.5, 4, "g", ("0.5", "0.5")),
    ],
)
def test_figures_are_told_apart(
    value: float, bound: float, digits: int, form: str, told: tuple[str, str]
) -> None:
    assert told_apart(value, bound, digits, form) == told
