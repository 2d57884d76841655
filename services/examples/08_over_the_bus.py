"""The same Law over Zenoh: a server in one place, questions from another; here both in one process."""

import socket

from services import connect
from services.bus.serving import alone
from services.bus.sessions import open_session


def main() -> None:
    """Serve kitchen B on an endpoint of loopback where nobody listens yet, and ask it."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        endpoint = f"tcp/127.0.0.1:{probe.getsockname()[1]}"

    # On the command line this is: sdt serve --kitchen b --robot pr2 --bus ENDPOINT
    with (
        open_session(listen=endpoint) as session,
        alone(session, ("b",), ("pr2",)),
        connect("b", endpoint) as kitchen,  # and this: sdt ask b satisfies --connect ENDPOINT
    ):
        print(len(kitchen.satisfies()), "requests are met by the present state")
        columns, rows = kitchen.select("SELECT ?door { ?door a sdt:Door }")
        print(columns, len(rows))
        print("causes:", kitchen.causes("open:iai_fridge_door").holds)


if __name__ == "__main__":  # the server judges in processes of its own, which import this file again
    main()
