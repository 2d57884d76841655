"""`sdt mcp` goes on whatever comes down its standard input, and answers the next call."""

import json
import subprocess
import sys
from typing import Any

import pytest

GARBAGE = [
    *(
        b"garbage",
        b"{",
        b"[]",
        b"null",
        b"\xff\xfe\x00",
        b"[" * 100_000,
        b'{"a":' * 100_000,
        b"x" * 5_000_000,
    ),
    *(b'{"jsonrpc":"2.0","id":{"a":1},"method":"tools/list"}', b'{"jsonrpc":"2.0","id":3,"method":"dance"}'),
    b'{"jsonrpc":"2.0","id":4,"method":"tools/call","params":{"name":7}}',
    b'{"jsonrpc":"2.0","id":5,"method":"tools/call","params":{"name":"lookup","arguments":{"name":"\\ud800"}}}',
    b'{"jsonrpc":"2.0","id":6,"method":"tools/call","params":{"name":"lookup","arguments":{"name":NaN}}}',
]
LAST = 99


def line(number: int | None, method: str, **params: Any) -> bytes:
    """One message."""
    named = {} if number is None else {"id": number}
    return json.dumps({"jsonrpc": "2.0", **named, "method": method, "params": params}).encode()


@pytest.mark.oracle
def test_garbage_on_standard_input_stops_no_agent() -> None:
    hello = {"protocolVersion": "2025-06-18", "capabilities": {}, "clientInfo": {"name": "x", "version": "0"}}
    begin = [line(1, "initialize", **hello), line(None, "notifications/initialized")]
    call = line(LAST, "tools/call", name="lookup", arguments={"name": "fridge_area"})
    words = [sys.executable, "-m", "services.cli", "mcp", "--kitchen", "b", "--robot", "pr2"]
    with subprocess.Popen(words, stdin=subprocess.PIPE, stdout=subprocess.PIPE) as server:
        assert server.stdin is not None
        assert server.stdout is not None
        server.stdin.write(b"".join(each + b"\n" for each in begin))
        server.stdin.flush()
        assert json.loads(server.stdout.readline())["id"] == 1
        server.stdin.write(b"".join(each + b"\n" for each in [*GARBAGE, call]))
        server.stdin.flush()
        answers = {}
        while LAST not in answers:
            said = json.loads(server.stdout.readline())
            answers[said.get("id")] = said
        server.stdin.close()
        assert server.wait(60) == 0
    assert not answers[LAST]["result"].get("isError")
    assert "fridge_area" in answers[LAST]["result"]["content"][0]["text"]
    assert {number for number, each in answers.items() if "error" in each} >= {3, 4}
