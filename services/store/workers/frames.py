"""Frames on a local socket: a JSON head and a body of bytes, each with its length before it."""

import asyncio
import json
import socket
import struct
from typing import Any, Final

_LENGTHS: Final = struct.Struct(">IQ")

Head = dict[str, Any]  # JSON object


def packed(head: Head, body: bytes = b"") -> bytes:
    """One frame."""
    text = json.dumps(head, separators=(",", ":")).encode()
    return _LENGTHS.pack(len(text), len(body)) + text + body


def receive(channel: socket.socket) -> tuple[Head, bytes]:
    """The next frame of a blocking socket.

    Raises:
        EOFError: The other end is closed.
    """
    head, body = _LENGTHS.unpack(_exactly(channel, _LENGTHS.size))
    return json.loads(_exactly(channel, head)), _exactly(channel, body)


async def read(stream: asyncio.StreamReader) -> tuple[Head, bytes]:
    """The next frame of a stream.

    Raises:
        asyncio.IncompleteReadError: The other end is closed.
    """
    head, body = _LENGTHS.unpack(await stream.readexactly(_LENGTHS.size))
    text = await stream.readexactly(head)
    return json.loads(text), await stream.readexactly(body) if body else b""


def _exactly(channel: socket.socket, count: int) -> bytes:
    buffer = bytearray(count)
    view, done = memoryview(buffer), 0
    while done < count:
        got = channel.recv_into(view[done:])
        if not got:
            raise EOFError
        done += got
    return bytes(buffer)
