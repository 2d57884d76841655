"""The page on a socket: everybody who connects gets a session of their own."""

import threading
from typing import Final

import viser

from services.http.settings import Address
from services.viewer.choice import wanted
from services.viewer.desk import Desk
from services.viewer.doors.gate import serve
from services.viewer.session import Session

LABEL: Final = "sdt"
LEAVING: Final = 2.0
"""[s] A session may take to end."""
MOST_PEOPLE: Final = 32
"""At a time; each has a thread and a scene."""


class Page:
    """A running page.

    Args:
        address: Where to listen; port 0 is any free one.
        desk: What is on offer.
        hosts: Other names of this service.

    Raises:
        InputError: The port is taken, or the address is not of this machine.
    """

    def __init__(self, address: Address, desk: Desk, hosts: tuple[str, ...] = ()) -> None:
        self._sessions: dict[int, Session] = {}
        self._lock = threading.Lock()
        self._desk = desk
        self._server = serve(address, LABEL, hosts)
        _light(self._server.scene)
        self._server.scene.world_axes.visible = False
        self._server.on_client_connect(self._arrived)
        self._server.on_client_disconnect(self._left)
        self.port = self._server.get_port()
        self.url = f"http://{address.host}:{self.port}/"

    def close(self) -> None:
        """Nobody is served any longer."""
        sessions = list(self._sessions.values())
        for session in sessions:
            session.leave()
        for session in sessions:
            session.join(LEAVING)
        self._server.stop()

    async def _arrived(self, client: viser.ClientHandle) -> None:
        with self._lock:
            full = len(self._sessions) >= MOST_PEOPLE
            if not full:
                session = Session(client, self._desk, wanted(self._path(client)))
                self._sessions[client.client_id] = session
                session.start()
        if full:
            client.add_notification("Full", f"{MOST_PEOPLE} people look already; come again in a while.")

    async def _left(self, client: viser.ClientHandle) -> None:
        with self._lock:
            session = self._sessions.pop(client.client_id, None)
        if session is not None:
            session.leave()

    def _path(self, client: viser.ClientHandle) -> str:
        """Path of the connection, which a link to a case has written its case into."""
        connection = self._server._websock_server._live_connections.get(client.client_id)
        request = None if connection is None else connection.request
        return "" if request is None else request.path


def _light(scene: viser.SceneApi) -> None:
    """Plain light for all: viser's own, with its shadows and its picture of a city, is slow without a GPU."""
    scene.configure_environment_map(None)
    scene.configure_default_lights(enabled=False)
    scene.add_light_hemisphere("/light/sky", ground_color=(120, 120, 130), intensity=2.2)
    scene.add_light_directional("/light/sun", intensity=1.4, cast_shadow=False, position=(-2.0, -3.0, 6.0))
