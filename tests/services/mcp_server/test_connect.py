"""`sdt mcp --connect` where nobody listens ends at once, rather than with an agent that waits."""

from click.testing import CliRunner

from sdt_kg.errors import OracleUnavailableError
from services.cli import sdt
from tests.ports import free_endpoint


def test_nobody_at_the_endpoint_is_said_before_anything_is_served() -> None:
    said = CliRunner().invoke(
        sdt, ["mcp", "--kitchen", "b", "--robot", "pr2", "--connect", free_endpoint()], input=""
    )
    assert isinstance(said.exception, OracleUnavailableError)
    assert "cannot reach tcp/127.0.0.1" in str(said.exception)
