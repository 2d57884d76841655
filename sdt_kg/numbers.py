"""Numbers as people and files write them."""


def number_in(text: str) -> float:
    """The number that a text is, infinite or none at all where it says so: inf, nan.

    Raises:
        ValueError: It is none, or one in Python alone: of `0_1`, most likely a slip for 0.1, Python makes 1.
    """
    if "_" in text or not text.isascii():
        raise ValueError(f"'{text}' is no number")
    return float(text)
