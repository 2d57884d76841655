"""Bytes ↔ values; no I/O.

A payload is JSON, or CBOR where the encoding says so; in CBOR, arrays may be RFC 8746 typed arrays
(tag 86, little-endian float64; tag 40 around it for more than one dimension).
"""

import json
from collections import Counter
from collections.abc import Callable, Mapping
from io import BytesIO
from typing import Any, NoReturn, TypeVar

import cbor2
import numpy as np
from pydantic import BaseModel, ValidationError
from pydantic_core import from_json

from sdt_kg.errors import InputError
from services.judging.messages import SCHEMA, Message

M = TypeVar("M", bound=Message)

JSON, CBOR = "application/json", "application/cbor"
MAX_REQUEST = 16 * 2**20
"""[bytes] A body motion of 10,000 samples and 50 joints is 4 MB."""
MAX_REPLY = 64 * 2**20
"""[bytes] Rows of a query, verdicts with their quads."""
MAX_CELLS = 4_000_000
"""Numbers in one array."""

_MULTI_DIMENSIONAL, _FLOAT64_LE = 40, 86


def _refused(*_: object) -> NoReturn:
    """A tag that is not ours."""
    raise ValueError(f"allowed are the tags {_MULTI_DIMENSIONAL} and {_FLOAT64_LE}")


_NOT_OURS: dict[int, Callable[..., NoReturn]] = dict.fromkeys(
    (0, 1, 2, 3, 4, 5, 25, 28, 29, 30, 35, 36, 37, 52, 54, 100, 256, 258, 260, 261, 1004, 43000, 55799),
    _refused,
)
"""Tags that cbor2 reads by itself; with 28 and 29, shared references, 400 bytes are a list of 2⁶⁰ items."""


def encode(message: BaseModel) -> bytes:
    """The message as JSON."""
    return message.model_dump_json(by_alias=True).encode()


def encode_cbor(message: BaseModel) -> bytes:
    """The message as CBOR; arrays as typed arrays."""
    return to_cbor(message.model_dump(by_alias=True))


def to_cbor(value: object) -> bytes:
    """Plain values and float64 arrays as CBOR."""
    return cbor2.dumps(value, default=_array_to_cbor)


def arrays_of(motion: Mapping[str, object] | None) -> dict[str, Any] | None:
    """A motion as CBOR carries it: numbers as float64 arrays, names as lists.

    Raises:
        InputError: It is not by name.
    """
    if motion is None:
        return None
    if not isinstance(motion, Mapping):
        what, allowed = f"a motion that is a {type(motion).__name__}", "arrays by name, as in a motion file"
        raise InputError(what, allowed=allowed, remedy="services.motions.read_arrays(path) reads them")
    arrays = {name: np.asarray(value) for name, value in motion.items()}
    return {name: each if each.dtype.kind == "f" else each.tolist() for name, each in arrays.items()}


def decode(kind: type[M], payload: bytes, encoding: str = JSON) -> M:
    """The message in a payload.

    Raises:
        InputError: No JSON or CBOR, a field is missing or wrong, or another major version.
    """
    if len(payload) > MAX_REPLY:
        raise InputError(f"a message of {len(payload)} bytes", allowed=f"at most {MAX_REPLY}")
    raw = from_cbor(payload) if encoding == CBOR else _from_json(payload)
    if not isinstance(raw, dict):
        raise InputError(f"the message is a {type(raw).__name__}", allowed="an object with named fields")
    version = raw.get("schema", SCHEMA)
    if not isinstance(version, str):
        raise InputError(f"the schema is a {type(version).__name__}", allowed=f"text such as '{SCHEMA}'")
    if version.partition(".")[0] != SCHEMA.partition(".")[0]:
        raise InputError(f"the message has the schema {version}", allowed=SCHEMA)
    return message_of(kind, raw)


def message_of(kind: type[M], fields: Mapping[str, object]) -> M:
    """The message with these fields.

    Raises:
        InputError: One is missing, wrong, or nearly one that there is.
    """
    try:
        return kind.model_validate(fields)
    except ValidationError as error:
        wrong = error.errors(include_url=False, include_input=False, include_context=False)
        first = wrong[0]
        where = ".".join(str(each) for each in first["loc"])
        of = f"'{where}' of {kind.__name__}" if where else kind.__name__
        more = f" (and {len(wrong) - 1} more)" if len(wrong) > 1 else ""
        raise InputError(f"{of}: {first['msg']}{more}") from None


def asked_in(kind: type[M], payload: bytes, encoding: str = JSON) -> M:
    """The request in a payload, which says nothing twice.

    Raises:
        InputError: It does, or as `decode`.
    """
    request = decode(kind, payload, encoding)
    if encoding != CBOR:
        check_once(payload)
    return request


def check_once(payload: bytes) -> None:
    """No object of this JSON has a name twice: which of its values is meant is not for us to choose.

    Raises:
        InputError: One has, or it is no JSON.
    """
    try:
        json.loads(payload or b"{}", object_pairs_hook=_once)
    except (ValueError, RecursionError) as error:
        raise InputError(f"the payload is no JSON: {error}", allowed=JSON) from None


def _once(pairs: list[tuple[str, object]]) -> dict[str, object]:
    said = dict(pairs)
    if len(said) < len(pairs):
        ((twice, _),) = Counter(name for name, _ in pairs).most_common(1)
        raise InputError(f"'{twice[:40]}' is there twice", allowed="every name once")
    return said


def _from_json(payload: bytes) -> object:
    try:
        # Unlike Python's own it takes no half of a surrogate pair, which nobody could write again.
        return from_json(payload or b"{}", allow_inf_nan=False)
    except ValueError as error:
        raise InputError(f"the payload is no JSON: {error}", allowed=f"{JSON} or {CBOR}") from None


def from_cbor(payload: bytes) -> Any:  # noqa: ANN401 - what CBOR carries
    """Plain values and float64 arrays.

    Raises:
        InputError: The bytes are no CBOR, have a tag that is not ours, a name twice, or more after the end.
    """
    stream = BytesIO(payload)
    try:
        said = cbor2.load(
            stream, tag_hook=_array_from_cbor, semantic_decoders=_NOT_OURS, allow_duplicate_keys=False
        )
    except (cbor2.CBORError, ValueError, RecursionError) as error:
        why = f": {error.__cause__}" if error.__cause__ else ""
        raise InputError(f"the payload is no CBOR: {error}{why}", allowed=f"{JSON} or {CBOR}") from None
    if after := len(payload) - stream.tell():
        raise InputError(f"{after} bytes come after the end of the message", allowed="one message")
    return said


def _array_to_cbor(encoder: Any, value: object) -> None:  # noqa: ANN401 - cbor2's encoder has no public protocol
    if not isinstance(value, np.ndarray):
        raise TypeError(f"a {type(value).__name__} in a message")
    flat = cbor2.CBORTag(_FLOAT64_LE, np.ascontiguousarray(value, dtype="<f8").tobytes())
    encoder.encode(flat if value.ndim == 1 else cbor2.CBORTag(_MULTI_DIMENSIONAL, [list(value.shape), flat]))


def _array_from_cbor(tag: cbor2.CBORTag, immutable: bool = False) -> object:
    del immutable
    if tag.tag == _FLOAT64_LE and isinstance(tag.value, bytes):
        return np.frombuffer(tag.value, dtype="<f8") if tag.value else np.zeros(0)
    if tag.tag == _MULTI_DIMENSIONAL:
        shape, flat = tag.value
        if isinstance(flat, np.ndarray) and int(np.prod(shape)) == flat.size <= MAX_CELLS:
            return flat.reshape(tuple(int(each) for each in shape))
    raise ValueError(f"tag {tag.tag} is not a float64 array")
