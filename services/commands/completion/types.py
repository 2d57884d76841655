"""Parameters whose values a shell completes; commands get plain text, and check it where it is used."""

from collections.abc import Iterable

import click
from click.shell_completion import CompletionItem

STATES = ("all=open", "all=closed", "all=half-open:0", "asked=open")
VERBS = ("open", "close")


class Model(click.ParamType):
    """A bundled kitchen or robot, or a file."""

    def __init__(self, kind: str) -> None:
        self.name, self.kind = kind, kind

    def shell_complete(
        self, ctx: click.Context, param: click.Parameter, incomplete: str
    ) -> list[CompletionItem]:
        """Bundled names; files where none begins so."""
        from services.commands.completion.names import bundled  # noqa: PLC0415 - only to complete

        del ctx, param
        return _beginning(bundled(self.kind), incomplete) or [CompletionItem(incomplete, type="file")]


class Container(click.ParamType):
    """A container of the kitchen that the line names."""

    name = "container"

    def shell_complete(
        self, ctx: click.Context, param: click.Parameter, incomplete: str
    ) -> list[CompletionItem]:
        """Its containers."""
        del param
        return _beginning(_names(ctx, "containers"), incomplete)


class AskedTask(click.ParamType):
    """`open`, `close`, `open:CONTAINER`, `close:CONTAINER`."""

    name = "task"

    def shell_complete(
        self, ctx: click.Context, param: click.Parameter, incomplete: str
    ) -> list[CompletionItem]:
        """Verbs, then the verbs with containers."""
        del param
        if ":" not in incomplete:
            return _beginning([word for verb in VERBS for word in (verb, f"{verb}:")], incomplete)
        verb = incomplete.partition(":")[0]
        return _beginning([f"{verb}:{name}" for name in _names(ctx, "containers")], incomplete)


class JointState(click.ParamType):
    """`JOINT=VALUE` or `CONTAINER=open`."""

    name = "joint=value"

    def shell_complete(
        self, ctx: click.Context, param: click.Parameter, incomplete: str
    ) -> list[CompletionItem]:
        """Joints and containers, then what a container can be."""
        del param
        name, equals, _ = incomplete.partition("=")
        if equals and name != "all":
            return _beginning([f"{name}=open", f"{name}=closed"], incomplete)
        known = [f"{each}=" for kind in ("containers", "joints") for each in _names(ctx, kind)]
        return _beginning([*STATES, *known], incomplete)


KITCHEN, ROBOT = Model("kitchen"), Model("robot")
CONTAINER, TASK, STATE = Container(), AskedTask(), JointState()


def _beginning(words: Iterable[str], incomplete: str) -> list[CompletionItem]:
    return [CompletionItem(word) for word in words if word.startswith(incomplete)]


def _names(ctx: click.Context, kind: str) -> list[str]:
    """Names of the kitchen that was typed before; else of the settings; none without either."""
    from services.commands.completion.names import first_kitchen, names_of  # noqa: PLC0415 - only to complete

    known = ctx.find_object(dict) or {}
    # Where an option still lacks its value, click tells none of the arguments: they are looked for.
    typed = ctx.params.get("kitchen") or first_kitchen(known.get("words", []))
    kitchen = typed or known.get("kitchen")
    return names_of(kitchen)[kind] if isinstance(kitchen, str) else []
