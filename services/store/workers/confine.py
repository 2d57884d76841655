"""What a process that evaluates queries may not do.

Each wall stands alone: a network namespace with nothing in it (where the system allows one), and no
file descriptor left to open a socket or a file with (always).
"""

import ctypes
import os
import resource
import signal
import socket
from pathlib import Path
from typing import Final

CLONE_NEWUSER: Final = 0x10000000
CLONE_NEWNET: Final = 0x40000000
PR_SET_PDEATHSIG: Final = 1
PR_SET_DUMPABLE: Final = 4
PR_SET_NO_NEW_PRIVS: Final = 38

CHANNEL: Final = 3
"""Descriptor of a worker's only socket, after the three standard ones."""

_libc = ctypes.CDLL(None, use_errno=True)


def leave_network() -> bool:
    """Whether this process and its children are now in a network namespace with no interface up."""
    return any(_libc.unshare(flags) == 0 for flags in (CLONE_NEWNET, CLONE_NEWUSER | CLONE_NEWNET))


def die_with_parent() -> None:
    """This process is killed when the one that started it ends."""
    _libc.prctl(PR_SET_PDEATHSIG, signal.SIGKILL, 0, 0, 0)


def own_size() -> int:
    """Address space that this process has [bytes]."""
    return int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()


def peak() -> int:
    """The most memory that this process has had at a time [bytes]."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024


def limit_memory(most: int) -> None:
    """This process gets no more address space than this [bytes]; beyond it an allocation fails.

    Nor does a failure trace where it was, whatever the environment says: a trace wants memory, too, and where
    it gets none Rust waits for the lock that it holds.
    """
    os.environ["RUST_BACKTRACE"] = "0"
    resource.setrlimit(resource.RLIMIT_AS, (most, most))


def confine(channel: socket.socket, errors: int) -> socket.socket:
    """The channel, as the only thing that is left to this process.

    Args:
        channel: To who asks.
        errors: Descriptor of what stands in for standard error.
    """
    nothing = os.open(os.devnull, os.O_RDWR)
    inherited = os.dup(channel.detach())
    for source, target in ((nothing, 0), (nothing, 1), (errors, 2), (inherited, CHANNEL)):
        os.dup2(source, target)
    os.closerange(CHANNEL + 1, resource.getrlimit(resource.RLIMIT_NOFILE)[0])
    confined = socket.socket(fileno=CHANNEL)
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    resource.setrlimit(resource.RLIMIT_NOFILE, (CHANNEL + 1, CHANNEL + 1))
    _libc.prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0)
    _libc.prctl(PR_SET_DUMPABLE, 0, 0, 0, 0)
    return confined
