"""The examples that a server shows of itself are questions that it answers."""

import json

import pytest
import zenoh

from services.bus import examples, keys
from services.bus.client import Connection
from services.judging.messages import Verb

pytestmark = pytest.mark.oracle


@pytest.mark.parametrize("verb", [verb for verb in Verb if verb is not Verb.WHY])
def test_the_example_of_each_request_is_answered(session: zenoh.Session, verb: Verb) -> None:
    payload = json.dumps(examples.REQUESTS[verb])
    (reply,) = list(session.get(keys.rpc("b", verb), payload=payload, timeout=60))
    assert reply.ok is not None, reply.err and reply.err.payload.to_string()
    if verb is Verb.SWEEP:
        Connection(session, "b").cancel(json.loads(reply.ok.payload.to_bytes())["job"])
