"""A client that speaks the page's protocol without a browser: what it is shown, and what it does."""

import html
import math
import re
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import msgspec
import pytest
import viser
import zstandard
from viser import _messages as wire
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import connect
from websockets.typing import Origin, Subprotocol

PATIENCE = 150
"""[s] A judge compiles on its first run after an installation."""
CAMERA = wire.ViewerCameraMessage(
    (1.0, 0.0, 0.0, 0.0), (3.0, 0.0, 1.0), 1.0, 0.1, 100.0, 720, 1280, (0.0, 0.0, 0.0), (0.0, 0.0, 1.0)
)


@dataclass
class Visitor:
    """Somebody who is connected.

    Attributes:
        controls: uuid → properties, value and kind of each control that is there.
        nodes: Name of each node of the scene → the message that made it.
        said: Titles and texts of notifications.
    """

    port: int
    path: str = "/"
    controls: dict[str, dict[str, Any]] = field(default_factory=dict)
    nodes: dict[str, dict[str, Any]] = field(default_factory=dict)
    said: list[str] = field(default_factory=list)
    files: list[dict[str, Any]] = field(default_factory=list)

    def __enter__(self) -> "Visitor":
        self.socket = connect(
            f"ws://127.0.0.1:{self.port}{self.path}",
            origin=Origin(f"http://127.0.0.1:{self.port}"),
            subprotocols=[Subprotocol(f"viser-v{viser.__version__}")],
            open_timeout=30,
            max_size=None,
        )
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()
        self.send(CAMERA)
        return self

    def __exit__(self, *_: object) -> None:
        self.socket.close()
        self._reader.join(5)

    def send(self, message: wire.Message) -> None:
        self.socket.send(msgspec.msgpack.encode(message.as_serializable_dict()))

    def _read(self) -> None:
        try:
            for frame in self.socket:
                assert isinstance(frame, bytes)
                packed = int.from_bytes(frame[8:16], "little")
                plain = zstandard.ZstdDecompressor().decompress(frame[16 : 16 + packed])
                for message in msgspec.msgpack.decode(plain)["messages"]:
                    self._take(message)
        except ConnectionClosed:
            return

    def _take(self, message: dict[str, Any]) -> None:
        kind = str(message["type"])
        if kind.startswith("Notification"):
            self.said.append(f"{message['props']['title']}: {message['props']['body']}")
        elif kind == "FileTransferStartDownload":
            self.files.append(message)
        elif kind.startswith("Gui"):
            self._take_control(kind, message)
        elif kind == "RemoveSceneNodeMessage":
            self.nodes.pop(message["name"], None)
        elif "name" in message:
            self._take_node(message)

    def _take_control(self, kind: str, message: dict[str, Any]) -> None:
        if kind == "GuiUpdateMessage":
            self.controls.get(message["uuid"], {}).update(message["updates"])
        elif kind == "GuiRemoveMessage":
            self.controls.pop(message["uuid"], None)
        elif "props" in message:
            self.controls[message["uuid"]] = {"value": message.get("value"), **message["props"]}

    def _take_node(self, message: dict[str, Any]) -> None:
        if "props" in message:
            self.nodes[message["name"]] = message
        elif message["name"] in self.nodes:
            self.nodes[message["name"]].update({name: at for name, at in message.items() if name != "type"})

    def control(self, label: str) -> tuple[str, dict[str, Any]]:
        """The only one of that label, as soon as it is there."""
        self.until(lambda: len(self._labelled(label)) == 1, f"one control {label}")
        return self._labelled(label)[0]

    def _labelled(self, label: str) -> list[tuple[str, dict[str, Any]]]:
        return [(uuid, each) for uuid, each in list(self.controls.items()) if each.get("label") == label]

    def value(self, label: str) -> Any:
        return self.control(label)[1]["value"]

    def sets(self, label: str, value: object) -> None:
        uuid, control = self.control(label)
        control["value"] = value
        self.send(wire.GuiUpdateMessage(uuid, {"value": value}))

    def clicks(self, label: str) -> None:
        uuid, _ = self.control(label)
        self.send(wire.GuiUpdateMessage(uuid, {"value": True}))

    def drags(self, name: str, x: float, y: float, yaw: float = 0.0) -> None:
        """A gizmo is dragged over the floor and let go."""
        node = self.nodes[name]
        owner, turned = node.get("owner", ""), (math.cos(yaw / 2), 0.0, 0.0, math.sin(yaw / 2))
        self.send(wire.TransformControlsDragStartMessage(name, owner))
        self.send(wire.TransformControlsUpdateMessage(name, turned, (x, y, node["position"][2]), owner))
        self.send(wire.TransformControlsDragEndMessage(name, owner))

    def outcome(self) -> str:
        """Of the verdict that is shown and is not about something else by now; else empty."""
        text = self.reads()
        found = re.search(r"NOT CERTIFIED|CERTIFIED|ABSTAINED", text)
        return "" if found is None or "Something was changed since" in text else found[0]

    def opens(self, label: str, name: str, content: bytes) -> None:
        uuid, _ = self.control(label)
        self.send(wire.FileTransferStartUpload(uuid, name, name, "", 1, len(content)))
        self.send(wire.FileTransferPart(uuid, name, 0, content))

    def reads(self) -> str:
        """Everything that is written in panels, without tags."""
        parts = (each.get("content") or each.get("_markdown") or "" for each in list(self.controls.values()))
        return html.unescape(re.sub(r"<[^>]+>", " ", "\n".join(parts)))

    def waits_for(self, text: str) -> str:
        return self.until(lambda: text in self.reads() or any(text in each for each in self.said), text)

    def until(self, seen: Callable[[], bool], what: str) -> str:
        end = time.monotonic() + PATIENCE
        while time.monotonic() < end:
            if seen():
                return self.reads()
            time.sleep(0.02)
        pytest.fail(f"never seen: {what}; the page says: {self.reads()} {self.said}")
