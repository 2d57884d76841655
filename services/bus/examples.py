"""An example of each request, and of the replies that are short, as `@meta/schema` shows them: kitchen b."""

from typing import Any, Final

from services.judging.messages import Verb
from services.judging.problems import ProblemType, problem

Example = dict[str, Any]  # JSON

DRAWER: Final = "kitchen_island_left_upper_drawer_main"
_TASK: Final = f"open:{DRAWER}"
_JOINT: Final = f"{DRAWER}_joint"
_VERDICT: Final = "https://example.org/id/verdict/" + "0" * 64
_TAU: Final = {"joint": _JOINT, "times": [0.0, 8.0], "values": [0.0, 0.45], "timed": False}

HEADER: Final[Example] = {
    "schema": "1.0",
    "id": "9f1c",
    "deadline_ms": 30_000,
    "traceparent": "00-0af7651916cd43dd8448eb211c80319c-b7ad6b7169203331-01",
}
PROBLEM: Final[Example] = problem(
    ProblemType.UNAVAILABLE, "64 requests wait already", retry_after=1.0, report="9f1c"
).model_dump()
REQUESTS: Final[dict[Verb, Example]] = {
    Verb.SELECT: {"query": "SELECT ?d WHERE { ?d a sdt:Door }"},
    Verb.ASK: {"query": "ASK { ?d a sdt:Door }"},
    Verb.CONSTRUCT: {"query": "CONSTRUCT { ?d a sdt:Door } WHERE { ?d a sdt:Door }"},
    Verb.DESCRIBE: {"query": f"DESCRIBE <https://example.org/id/b/body/{DRAWER}>"},
    Verb.SATISFIES: {"state": [f"{DRAWER}=open"]},
    Verb.CAUSES: {"task": _TASK, "motion": _TAU},
    Verb.CANPERFORM: {"task": _TASK, "robot": "pr2", "drive": "omni", "friction": 0.5, "budget": 5.0},
    Verb.CANACHIEVE: {"task": _TASK, "robot": "pr2", "motion": _TAU, "quads": True},
    Verb.PLACE: {"task": _TASK, "robot": "pr2", "budget": 1.0},
    Verb.WHATIF: {"task": _TASK, "robot": "pr2", "edits": ["drive:fixed", f"jam:{DRAWER}"], "budget": 1.0},
    Verb.TASK: {"task": "open_then_close", "robot": "pr2", "seed": 1},
    Verb.COMPUTE: {"query": f"SELECT ?v {{ ?v law:container <https://example.org/id/b/body/{DRAWER}> }}"},
    Verb.WHY: {"iri": _VERDICT},
    Verb.SWEEP: {"tasks": [_TASK], "robots": ["pr2"], "seeds": [0, 1], "budget": 5.0},
    Verb.HISTORY: {"kind": "verdict", "after": 7, "epoch": "5d41402a", "limit": 10},
}
REPLIES: Final[dict[Verb, Example]] = {
    Verb.SATISFIES: {"requests": [{"verb": "open", "container": DRAWER}]},
    Verb.WHY: {"text": f"Can pr2 open {DRAWER} in kitchen b? CERTIFIED"},
    Verb.SWEEP: {"job": "0c54ba1c19d7.5f3a", "state": "running", "done": 1, "total": 2},
    Verb.HISTORY: {"epoch": "5d41402a", "first": 1, "last": 7, "more": False, "events": []},
}
