"""What `sdt` ends with: one table for all commands."""

from enum import IntEnum


class Exit(IntEnum):
    """Exit codes; `MEANING` says in words what `sdt --help` shows."""

    DONE = 0
    NO = 1
    BAD_INPUT = 2
    ABSTAINED = 3
    NO_ORACLE = 4
    BUG = 70  # EX_SOFTWARE of sysexits.h
    INTERRUPTED = 130  # 128 + SIGINT, as shells have it
    BROKEN_PIPE = 141  # 128 + SIGPIPE, as shells have it
    TERMINATED = 143  # 128 + SIGTERM, as shells have it


MEANING = {
    Exit.DONE: "done: all certified, in scope, consistent, well",
    Exit.NO: "the answer is no: something is not certified, does not hold, or is to be done",
    Exit.BAD_INPUT: "bad input: the line on standard error says what is allowed",
    Exit.ABSTAINED: "abstained: out of scope of D_artic, nothing is claimed",
    Exit.NO_ORACLE: "an oracle, server or store is unavailable: there is no verdict",
    Exit.BUG: "a bug of ours: please report what was printed",
    Exit.INTERRUPTED: "interrupted: with --save, verdicts that were finished are kept",
    Exit.BROKEN_PIPE: "nobody read the rest of the output",
    Exit.TERMINATED: "terminated: as interrupted",
}
