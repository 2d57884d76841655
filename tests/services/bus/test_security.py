"""The configurations that we ship let the right subject in, and tell the wrong one nothing."""

import shutil
import subprocess
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from pathlib import Path

import pytest
import zenoh

import services.bus
from sdt_kg.errors import OracleUnavailableError
from services.bus import keys
from services.bus.client import Connection
from services.bus.sessions import open_session
from services.judging.problems import BusUnavailableError, ForbiddenError, RequestError
from tests.ports import free_endpoint
from tests.services.bus.served import small

CONFIGS = Path(services.bus.__file__).parent / "config"
SUBJECTS = ("reader", "requester", "writer", "admin", "server", "nobody")
"""Names with a password; the access list says nothing about nobody."""
PASSWORDS = {name: f"secret of {name}" for name in SUBJECTS}
KEYS = {
    "sdt/v1/b/rpc/select": {"reader", "requester", "writer", "admin"},
    "sdt/v1/b/rpc/history": {"reader", "requester", "writer", "admin"},
    "sdt/v1/b/rpc/canachieve": {"requester", "writer", "admin"},
    "sdt/v1/b/rpc/place": {"requester", "writer", "admin"},
    "sdt/v1/b/rpc/whatif": {"requester", "writer", "admin"},
    "sdt/v1/b/rpc/task": {"requester", "writer", "admin"},
    "sdt/v1/b/rpc/compute": {"requester", "writer", "admin"},
    "sdt/v1/b/rpc/sweep": {"writer", "admin"},
    "sdt/v1/b/jobs/1/cancel": {"writer", "admin"},
    "sdt/v1/@oracle/causes/rpc/1": {"admin"},
}
SILENCE = 1.0
"""[s] A denied question stays without a reply."""


def _user(folder: Path, name: str, password: str, file: str = "") -> Path:
    text = (CONFIGS / "client-users.json5").read_text()
    path = folder / f"{file or name}.json5"
    path.write_text(text.replace('"reader"', f'"{name}"').replace("change-me", password))
    return path


@contextmanager
def _router(folder: Path) -> Iterator[tuple[str, zenoh.Session]]:
    """A router with the user configuration that we ship."""
    users = folder / "users.txt"
    users.write_text("".join(f"{name}:{password}\n" for name, password in PASSWORDS.items()))
    config = folder / "server.json5"
    text = (CONFIGS / "server-users.json5").read_text()
    config.write_text(text.replace('"users.txt"', f'"{users}"').replace("change-me", PASSWORDS["server"]))
    endpoint = free_endpoint()
    with open_session(listen=endpoint, mode="router", config=config) as session:
        yield endpoint, session


@pytest.fixture(scope="module")
def guarded(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[str, Path]]:
    """A router that answers at every key."""
    folder = tmp_path_factory.mktemp("users")
    with _router(folder) as (endpoint, session):
        for key in ("sdt/v1/**", "sdt/v1/@oracle/**"):
            session.declare_queryable(key, _reply)
        yield endpoint, folder


@pytest.fixture(scope="module")
def served(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[str, Path]]:
    """A router behind which there is a server of the small kitchen A."""
    folder = tmp_path_factory.mktemp("served")
    with _router(folder) as (endpoint, _):
        config = _user(folder, "server", PASSWORDS["server"])
        with open_session(connect=endpoint, mode="client", config=config) as session, small(session):
            yield endpoint, folder


@contextmanager
def _asking(where: tuple[str, Path], name: str, twin: str = "a") -> Iterator[Connection]:
    endpoint, folder = where
    config = _user(folder, name, PASSWORDS[name])
    with open_session(connect=endpoint, mode="client", config=config) as session:
        yield Connection(session, twin, deadline=10.0)


def _reply(query: zenoh.Query) -> None:
    with query:
        query.reply(query.key_expr, b"answer")


def _lie(query: zenoh.Query) -> None:
    with query:
        query.reply(query.key_expr, b"certified")


@pytest.mark.parametrize("name", ["reader", "requester", "writer", "admin"])
def test_each_subject_gets_what_it_may_and_nothing_else(guarded: tuple[str, Path], name: str) -> None:
    endpoint, folder = guarded
    config = _user(folder, name, PASSWORDS[name])
    with open_session(connect=endpoint, mode="client", config=config) as session:
        allowed = {key for key in KEYS if list(session.get(key, timeout=SILENCE))}
    assert allowed == {key for key, names in KEYS.items() if name in names}


def test_a_known_user_is_told_what_is_forbidden_and_gets_what_is_not(served: tuple[str, Path]) -> None:
    with _asking(served, "reader") as to:
        assert to.ask("ASK { ?d a sdt:Drawer }")
        for forbidden in (
            lambda: to.achieve("open"),
            to.sweep,
            lambda: to.progress("1"),
            lambda: to.cancel(keys.job_id(to.servers()[0], "1")),
        ):
            with pytest.raises(ForbiddenError, match="never hears sdt/v1/a/") as refused:
                forbidden()
            assert not refused.value.problem.retryable
        assert to.ask("ASK { ?d a sdt:Drawer }")
    with _asking(served, "writer") as to, pytest.raises(RequestError, match="no job"):
        to.progress("1")


def test_whom_the_list_does_not_name_cannot_tell_a_twin_from_one_that_is_not_there(
    served: tuple[str, Path],
) -> None:
    said: list[str] = []
    for twin in ("a", "z"):
        with _asking(served, "nobody", twin) as to:
            assert not to.servers()
            for question in (lambda to=to: to.ask("ASK { ?d a sdt:Drawer }"), lambda to=to: to.progress("1")):
                with pytest.raises(BusUnavailableError) as silence:
                    question()
                said.append(str(silence.value).replace(f"'{twin}'", "it"))
    assert said == ["Nobody can answer now: no server of it is on the bus"] * 4


def test_a_wrong_name_or_password_does_not_get_in(guarded: tuple[str, Path]) -> None:
    endpoint, folder = guarded
    configs = [
        _user(folder, name, password, f"wrong-{number}")
        for number, (name, password) in enumerate((("reader", "wrong"), ("stranger", "x"), ("reader", "")))
    ]

    def refused(config: Path) -> str:
        with pytest.raises(BusUnavailableError) as error:
            open_session(connect=endpoint, mode="client", config=config).close()
        return str(error.value)

    with ThreadPoolExecutor(len(configs)) as at_once:  # each is tried for three seconds
        (said,) = set(at_once.map(refused, configs))
    assert "nobody listens there, or this name or certificate is refused" in said
    with open_session(
        connect=endpoint, mode="client", config=_user(folder, "reader", PASSWORDS["reader"])
    ) as ok:
        assert list(ok.get("sdt/v1/b/rpc/select", timeout=SILENCE))


def test_a_wildcard_does_not_get_around_the_rules(guarded: tuple[str, Path]) -> None:
    endpoint, folder = guarded
    config = _user(folder, "reader", PASSWORDS["reader"])
    with open_session(connect=endpoint, mode="client", config=config) as session:
        for key in ("sdt/v1/**", "sdt/v1/b/rpc/*", "**"):
            assert not list(session.get(key, timeout=SILENCE))


@pytest.mark.parametrize("name", ["reader", "requester", "writer"])
def test_who_asks_can_neither_answer_nor_publish_nor_pass_for_a_server(
    guarded: tuple[str, Path], name: str
) -> None:
    endpoint, folder = guarded
    heard: list[str] = []
    with (
        open_session(connect=endpoint, mode="client", config=_user(folder, name, PASSWORDS[name])) as liar,
        open_session(
            connect=endpoint, mode="client", config=_user(folder, "admin", PASSWORDS["admin"])
        ) as to,
    ):
        to.declare_subscriber("sdt/v1/*/events/**", lambda sample: heard.append(str(sample.key_expr)))
        for key in ("sdt/v1/b/rpc/canachieve", "sdt/v1/b/rpc/select", "sdt/v1/b/@meta/health"):
            liar.declare_queryable(key, _lie, complete=True)
        liar.liveliness().declare_token("sdt/v1/b/@live/liar")
        time.sleep(SILENCE)
        liar.put("sdt/v1/b/events/verdict/000000000001", b"certified")
        to.put("sdt/v1/b/events/verdict/000000000002", b"told")
        until = time.monotonic() + 10
        while not heard and time.monotonic() < until:
            time.sleep(0.05)
        for key in ("sdt/v1/b/rpc/canachieve", "sdt/v1/b/rpc/select"):
            replies = to.get(key, target=zenoh.QueryTarget.ALL, timeout=SILENCE)
            assert {each.ok.payload.to_string() for each in replies if each.ok} == {"answer"}
        assert not list(to.liveliness().get("sdt/v1/b/@live/*", timeout=SILENCE))
    assert heard == ["sdt/v1/b/events/verdict/000000000002"]


def test_who_may_see_servers_sees_them_and_no_oracles_and_hears_what_is_published(
    guarded: tuple[str, Path],
) -> None:
    endpoint, folder = guarded
    heard: list[str] = []
    with (
        open_session(
            connect=endpoint, mode="client", config=_user(folder, "reader", PASSWORDS["reader"])
        ) as to,
        open_session(
            connect=endpoint, mode="client", config=_user(folder, "server", PASSWORDS["server"])
        ) as server,
    ):
        to.declare_subscriber("sdt/v1/*/events/**", lambda sample: heard.append(str(sample.key_expr)))
        tokens = [
            server.liveliness().declare_token(key)
            for key in ("sdt/v1/b/@live/one", "sdt/v1/@oracle/causes/@live/two")
        ]
        time.sleep(SILENCE)
        server.put("sdt/v1/b/events/state/000000000001", b"told")
        seen = {
            str(each.ok.key_expr)
            for key in ("sdt/v1/*/@live/*", "sdt/v1/@oracle/*/@live/*", "sdt/v1/@oracle/causes/@live/*")
            for each in to.liveliness().get(key, timeout=SILENCE)
            if each.ok
        }
        until = time.monotonic() + 10
        while not heard and time.monotonic() < until:
            time.sleep(0.05)
        for each in tokens:
            each.undeclare()
    assert seen == {"sdt/v1/b/@live/one"}
    assert heard == ["sdt/v1/b/events/state/000000000001"]


def test_what_is_denied_takes_as_long_where_there_is_somebody_as_where_there_is_nobody(
    guarded: tuple[str, Path],
) -> None:
    endpoint, folder = guarded
    config = _user(folder, "reader", PASSWORDS["reader"])
    with open_session(connect=endpoint, mode="client", config=config) as session:
        took: dict[str, float] = {}
        for key in ("sdt/v1/b/rpc/sweep", "other/nobody/is/here", "sdt/v1/b/@meta/x/y", "sdt/v1/z/@meta/x/y"):
            began = time.monotonic()
            assert not list(session.get(key, timeout=SILENCE))
            took[key] = time.monotonic() - began
        here, nowhere = ("sdt/v1/b/@meta/x/y", "sdt/v1/z/@meta/x/y")
    assert (took["sdt/v1/b/rpc/sweep"] < SILENCE / 2) == (took["other/nobody/is/here"] < SILENCE / 2)
    assert (took[here] < SILENCE / 2) == (took[nowhere] < SILENCE / 2)


def test_mutual_tls_lets_only_certificates_of_the_authority_in(tmp_path: Path) -> None:
    if shutil.which("openssl") is None:
        pytest.skip("no openssl to make certificates with")
    _authority(tmp_path, "ca")
    _authority(tmp_path, "other")
    for name, authority in (("server", "ca"), ("client", "ca"), ("stranger", "other")):
        _certificate(tmp_path, name, authority)
    endpoint = free_endpoint().replace("tcp/127.0.0.1", "tls/localhost")
    server = _placed(tmp_path, "server-tls.json5", "server")
    with open_session(listen=endpoint, mode="router", config=server) as session:
        session.declare_queryable("sdt/v1/**", _reply)
        client = _placed(tmp_path, "client-tls.json5", "client")
        with open_session(connect=endpoint, mode="client", config=client) as known:
            assert list(known.get("sdt/v1/b/rpc/select", timeout=5))
        stranger = _placed(tmp_path, "client-tls.json5", "stranger")
        with pytest.raises(OracleUnavailableError):
            open_session(connect=endpoint, mode="client", config=stranger).close()


def _placed(folder: Path, name: str, who: str) -> Path:
    """A configuration that we ship, with the files of this test."""
    text = (CONFIGS / name).read_text()
    for file in ("ca.pem", "server.pem", "server-key.pem", "client.pem", "client-key.pem"):
        text = text.replace(f'"{file}"', f'"{folder / file.replace("client", who)}"')
    path = folder / f"{who}.json5"
    path.write_text(text)
    return path


def _openssl(*arguments: str) -> None:
    found = shutil.which("openssl")
    assert found is not None
    subprocess.run([found, *arguments], check=True, capture_output=True)


def _authority(folder: Path, name: str) -> None:
    key, out = str(folder / f"{name}-key.pem"), str(folder / f"{name}.pem")
    new = ("req", "-x509", "-newkey", "rsa:2048", "-nodes", "-days", "2", "-subj", f"/CN={name}")
    _openssl(*new, "-keyout", key, "-out", out)


def _certificate(folder: Path, name: str, authority: str) -> None:
    key, request, out = (str(folder / f"{name}{end}") for end in ("-key.pem", ".csr", ".pem"))
    names = folder / f"{name}.ext"
    names.write_text("subjectAltName=DNS:localhost\n")
    new = ("req", "-newkey", "rsa:2048", "-nodes", "-subj", f"/CN={name}")
    _openssl(*new, "-keyout", key, "-out", request)
    ca = ("-CA", str(folder / f"{authority}.pem"), "-CAkey", str(folder / f"{authority}-key.pem"))
    _openssl("x509", "-req", "-in", request, *ca, "-days", "2", "-extfile", str(names), "-out", out)
