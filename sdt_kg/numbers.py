"""Numbers as people and files write them."""

DIGITS = 17
"""[1] Digits that tell any two numbers apart."""


def number_in(text: str) -> float:
    """The number that a text is, infinite or none at all where it says so: inf, nan.

    Raises:
        ValueError: It is none, or one in Python alone: of `0_1`, most likely a slip for 0.1, Python makes 1.
    """
    check_written(text)
    return float(text)


def whole_in(text: str) -> int:
    """The whole number that a text is; raises as `number_in`."""
    check_written(text)
    return int(text)


def check_written(text: str) -> None:
    """No number in Python alone; raises as `number_in`."""
    if "_" in text or not text.isascii():
        raise ValueError(f"'{text}' is no number")


def so_many(count: int, one: str, more: str) -> str:
    """How many there are of what is called so if it is one, and so if there are more or none."""
    return f"{count} {one if count == 1 else more}"


def told_apart(value: float, bound: float, digits: int, form: str = "g") -> tuple[str, str]:
    """Both figures with so many digits, or with as many more as it takes to tell them apart.

    Args:
        value: One figure.
        bound: The other.
        digits: At least; all of them for the form `g`, those behind the point for `f`.
        form: As in a format.
    """
    for count in range(digits, DIGITS + 1):
        told = f"{value:.{count}{form}}", f"{bound:.{count}{form}}"
        if told[0] != told[1]:
            return told
    return f"{value:.{digits}{form}}", f"{bound:.{digits}{form}}"
