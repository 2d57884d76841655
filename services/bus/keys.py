"""Key space of the bus: `sdt/v1/{twin}/…`. Nothing else spells a key.

```
sdt/v1/{twin}/rpc/{verb}               a question; any one server answers
sdt/v1/{twin}/rpc/{verb}/{instance}    the same question to one server; the key of its replies
sdt/v1/{twin}/jobs/{id}/{progress|result|cancel}
sdt/v1/{twin}/events/{state|verdict}/{sequence}
sdt/v1/{twin}/@meta/{schema|void|version|health|metrics}
sdt/v1/{twin}/@live/{instance}         liveliness token: the server is there
sdt/v1/@oracle/{kind}/rpc/{instance}   a question to one oracle: causes (Φ) or canperform (R)
sdt/v1/@oracle/{kind}/@live/{instance} liveliness token of an oracle
```

{twin} is the kitchen's name, percent-encoded as in IRIs: `my%20kitchen`.
`sdt/**` does not match chunks that begin with `@`, so listening to everything does not list servers.
"""

import re
from enum import Enum
from urllib.parse import quote

from sdt_kg.errors import InputError
from services.judging.messages import Verb

ROOT = "sdt/v1"
MOST_SHOWN = 200
"""Characters of a key that an error repeats."""
_CHUNK = re.compile(r"[A-Za-z0-9_.-]+")


class Oracle(Enum):
    """The relations that have an oracle of their own."""

    CAUSES = "causes"
    CANPERFORM = "canperform"


class Meta(Enum):
    """What a server says of itself."""

    SCHEMA = "schema"
    VOID = "void"
    VERSION = "version"
    HEALTH = "health"
    METRICS = "metrics"


class Part(Enum):
    """What a job can be asked for."""

    PROGRESS = "progress"
    RESULT = "result"
    CANCEL = "cancel"


def chunk(text: str) -> str:
    """The text, if it can be one chunk of a key.

    Raises:
        InputError: It has characters that mean something in a key expression.
    """
    if not _CHUNK.fullmatch(text):
        raise InputError(f"'{text}' cannot be part of a key", allowed="letters, digits, '_', '.', '-'")
    return text


def of_twin(twin: str) -> str:
    """What all keys about the twin begin with, whatever its name is.

    Raises:
        InputError: It has none.
    """
    if not twin:
        raise InputError("a twin that has no name", allowed="the name of the server's kitchen")
    return f"{ROOT}/{quote(twin, safe='')}"


def rpc(twin: str, verb: Verb, instance: str = "") -> str:
    """Key of a question, to any server or to one."""
    key = f"{of_twin(twin)}/rpc/{verb.value}"
    return f"{key}/{chunk(instance)}" if instance else key


def job_id(instance: str, number: str) -> str:
    """Id of a job: it tells which server has it."""
    return f"{instance}.{number}"


def server_of(job: str) -> str:
    """The server that has the job; empty where its id names none."""
    return job.partition(".")[0] if "." in job else ""


def job(twin: str, job_id: str, part: Part) -> str:
    """Key of a part of a job."""
    return f"{of_twin(twin)}/jobs/{chunk(job_id)}/{part.value}"


def event(twin: str, kind: str, sequence: int) -> str:
    """Key under which an event is published; sequences sort as text."""
    return f"{of_twin(twin)}/events/{chunk(kind)}/{sequence:012d}"


def meta(twin: str, part: Meta) -> str:
    """Key of what a server says of itself."""
    return f"{of_twin(twin)}/@meta/{part.value}"


def live(twin: str, instance: str) -> str:
    """Key of a server's liveliness token."""
    return f"{of_twin(twin)}/@live/{chunk(instance)}"


def any_live(twin: str) -> str:
    """Key expression of all servers of a twin."""
    return f"{of_twin(twin)}/@live/*"


def oracle(kind: Oracle, instance: str) -> str:
    """Key of a question to one oracle."""
    return f"{ROOT}/@oracle/{kind.value}/rpc/{chunk(instance)}"


def oracle_live(kind: Oracle, instance: str) -> str:
    """Key of an oracle's liveliness token."""
    return f"{ROOT}/@oracle/{kind.value}/@live/{chunk(instance)}"


def any_oracle(kind: Oracle) -> str:
    """Key expression of all oracles of a kind."""
    return f"{ROOT}/@oracle/{kind.value}/@live/*"


def instance_of(key: str) -> str:
    """The server that a liveliness token or a reply's key names."""
    return key.rsplit("/", 1)[-1]


def check_one(key: str) -> None:
    """The key is one key, and no expression that matches several.

    Raises:
        InputError: It is.
    """
    if "*" in key or "$" in key:
        what = f"'{key}' asks several at once" if len(key) <= MOST_SHOWN else "the key asks several at once"
        raise InputError(what, allowed=f"{ROOT}/TWIN/rpc/VERB, each of them named")


def job_of(key: str) -> tuple[str, Part] | None:
    """Job and part that a key names; None where it names none."""
    parts = key.split("/")
    try:
        return (parts[4], Part(parts[5])) if len(parts) == 6 and parts[3] == "jobs" else None
    except ValueError:
        return None


def asked(key: str) -> Verb | None:
    """The verb of a question's key; None where it names none that is known."""
    parts = key.split("/")
    try:
        return Verb(parts[4]) if len(parts) in {5, 6} and parts[3] == "rpc" else None
    except ValueError:
        return None
