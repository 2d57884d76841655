"""Numbers as people and files write them."""


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
