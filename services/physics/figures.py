"""Figures in words."""

MOST = 17
"""[1] Digits that tell any two numbers apart."""


def told_apart(value: float, bound: float, digits: int, form: str = "g") -> tuple[str, str]:
    """Both figures with so many digits, or with as many more as it takes to tell them apart.

    Args:
        value: One figure.
        bound: The other.
        digits: At least; all of them for the form `g`, those behind the point for `f`.
        form: As in a format.
    """
    for count in range(digits, MOST + 1):
        told = f"{value:.{count}{form}}", f"{bound:.{count}{form}}"
        if told[0] != told[1]:
            return told
    return f"{value:.{digits}{form}}", f"{bound:.{digits}{form}}"
