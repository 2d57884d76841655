"""What bash needs beyond click: words with `:` and `=` are one word, as `open:CONTAINER` is."""

import os
from typing import ClassVar

from click.shell_completion import (
    BashComplete,
    CompletionItem,
    ShellComplete,
    add_completion_class,
    split_arg_string,
)

_SOURCE = """\
%(complete_func)s() {
    local IFS=$'\\n' type value
    COMPREPLY=()
    while IFS=',' read -r type value; do
        case $type in
            dir) compopt -o dirnames ;;
            file) compopt -o default ;;
            plain) COMPREPLY+=("$value") ;;
        esac
        case $value in *:|*=) compopt -o nospace ;; esac
    done < <(COMP_LINE="$COMP_LINE" COMP_POINT="$COMP_POINT" %(complete_var)s=bash_complete "$1")
}
complete -o nosort -F %(complete_func)s %(prog_name)s
"""
_BREAKS = ":="
"""Characters at which bash begins another word, though they do not end one of ours."""


class Bash(BashComplete):
    """Completion in bash 4.4 and newer, from the whole line."""

    source_template: ClassVar[str] = _SOURCE

    def source(self) -> str:
        """The script; whether a bash is here does not matter to who prints it."""
        return ShellComplete.source(self)

    def get_completion_args(self) -> tuple[list[str], str]:
        """Words before the cursor, and the one that is begun."""
        line, before = os.environ["COMP_LINE"][: int(os.environ["COMP_POINT"])], words()
        self._begun = before.pop() if before and not line[-1:].isspace() else ""
        return before, self._begun

    def format_completion(self, item: CompletionItem) -> str:
        """What is to be put behind the last break of the word that is begun."""
        last = max(self._begun.rfind(each) for each in _BREAKS)
        return f"{item.type},{item.value[last + 1 :]}"


def words() -> list[str]:
    """The words of the line up to the cursor, as any of the shells tells them, without `sdt`."""
    line = os.environ.get("COMP_LINE", "")[: int(os.environ.get("COMP_POINT") or 0)]
    return split_arg_string(line or os.environ.get("COMP_WORDS", ""))[1:]


def register() -> None:
    """Have click use it."""
    add_completion_class(Bash)
