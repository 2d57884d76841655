"""Files from a browser, of a bounded size: viser itself would take in whatever is sent."""

from collections.abc import Callable
from typing import Final

import viser
from viser import _messages as wire  # the protocol has no public name

MOST: Final = 32 * 2**20
"""[bytes] Of one file, as over HTTP."""
AT_ONCE: Final = 4
"""Files of one person on their way."""

Refused = Callable[[str, str], None]


def bounded(client: viser.ClientHandle, refused: Refused) -> None:
    """Files of this person that are too large are not taken in.

    Args:
        client: Whose.
        refused: Told the transfer's id and why, once for each.
    """
    gui, connection = client.gui, client._websock_connection
    sizes: dict[str, int] = {}

    def start(client_id: int, message: wire.FileTransferStartUpload) -> None:
        if not 0 <= message.size_bytes <= MOST:
            size, most = message.size_bytes / 2**20, MOST // 2**20
            refused(message.transfer_uuid, f"'{message.filename}' has {size:.0f} MB; allowed: {most} MB")
        elif len(gui._current_file_upload_states) >= AT_ONCE:
            refused(message.transfer_uuid, f"{AT_ONCE} files are on their way; allowed: one after the other")
        else:
            sizes[message.transfer_uuid] = message.size_bytes
            gui._handle_file_transfer_start(client_id, message)  # pyright: ignore[reportArgumentType]  # its own id type

    def part(client_id: int, message: wire.FileTransferPart) -> None:
        left = sizes.get(message.transfer_uuid)
        if left is None:
            return
        sizes[message.transfer_uuid] = left - len(message.content)
        if left < len(message.content):
            del sizes[message.transfer_uuid]
            gui._current_file_upload_states.pop(message.transfer_uuid, None)
            refused(message.transfer_uuid, "the file is longer than it was said to be")
            return
        gui._handle_file_transfer_part(client_id, message)  # pyright: ignore[reportArgumentType]  # its own id type
        if message.transfer_uuid not in gui._current_file_upload_states:
            del sizes[message.transfer_uuid]

    connection.unregister_handler(wire.FileTransferStartUpload, gui._handle_file_transfer_start)
    connection.unregister_handler(wire.FileTransferPart, gui._handle_file_transfer_part)
    connection.register_handler(wire.FileTransferStartUpload, start)
    connection.register_handler(wire.FileTransferPart, part)


def hide_progress(client: viser.ClientHandle, transfer: str) -> None:
    """The browser no longer shows that a file is on its way."""
    client._websock_connection.queue_message(wire.RemoveNotificationMessage(f"upload-{transfer}"))
