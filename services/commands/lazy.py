"""A group whose subcommands are imported when they are run, so that help and completion are at once."""

from collections.abc import Iterator, Mapping, MutableMapping
from dataclasses import dataclass
from importlib import import_module

import click
from click.shell_completion import CompletionItem

from services.commands.exits import Exit
from services.garbage import unsought


@dataclass(frozen=True, slots=True)
class Listed:
    """A subcommand as the group's help lists it.

    Attributes:
        place: `module:attribute` of the command.
        help: What it does, in half a line.
    """

    place: str
    help: str

    def load(self) -> click.Command:
        """The command, imported; no garbage is looked for in what modules define."""
        module, attribute = self.place.split(":")
        with unsought():
            return getattr(import_module(module), attribute)


class LazyGroup(click.Group):
    """A group of listed subcommands, in sections.

    Attributes:
        sections: Title of each section, and its subcommands by name.
        closing: What the help says at the end, line by line.
    """

    def __init__(
        self, sections: Mapping[str, Mapping[str, Listed]], closing: str, **attributes: object
    ) -> None:
        super().__init__(**attributes)  # pyright: ignore[reportArgumentType]  # those of click.Group
        self.sections, self.closing = sections, closing
        self.commands = _Loading(
            {name: each for section in sections.values() for name, each in section.items()}
        )

    def invoke(self, ctx: click.Context) -> object:
        """Run the subcommand; where nobody reads what it prints, click itself would end with our "no"."""
        try:
            return super().invoke(ctx)
        except BrokenPipeError:
            raise SystemExit(Exit.BROKEN_PIPE) from None

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        """The subcommand that is meant.

        Of an option said twice click would take the last, without a word; of an option without its value it
        would take the next option for that.
        """
        name, command, rest = super().resolve_command(ctx, args)
        if command is not None and not ctx.resilient_parsing:
            _refuse_mistyped(click.Context(command, ctx, name), command, rest)
        return name, command, rest

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """The sections as they are listed, with nothing imported."""
        del ctx
        width = max(len(name) for section in self.sections.values() for name in section)
        for title, section in self.sections.items():
            with formatter.section(title):
                formatter.write_dl([(f"{name:<{width}}", each.help) for name, each in section.items()])

    def format_epilog(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """The closing lines, not wrapped."""
        del ctx
        formatter.write("\n")
        for line in self.closing.splitlines():
            formatter.write(f"{line}\n")

    def shell_complete(self, ctx: click.Context, incomplete: str) -> list[CompletionItem]:
        """Names of subcommands, with nothing imported."""
        found = [
            CompletionItem(name, help=each.help)
            for section in self.sections.values()
            for name, each in section.items()
            if name.startswith(incomplete)
        ]
        return [*found, *click.Command.shell_complete(self, ctx, incomplete)]


def _refuse_mistyped(ctx: click.Context, command: click.Command, args: list[str]) -> None:
    """Refuse an option that is given several times and takes one value, or whose value is left out.

    And an empty path, as a variable of a shell may be: it would be the folder where the command is run.
    """
    values, rest, said = command.make_parser(ctx).parse_args(list(args))
    if isinstance(command, click.Group):
        name, inner, rest = command.resolve_command(ctx, rest) if rest else (None, None, [])
        return _refuse_mistyped(click.Context(inner, ctx, name), inner, rest) if inner else None
    options = [each for each in command.get_params(ctx) if isinstance(each, click.Option)]
    for each in command.get_params(ctx):
        if isinstance(each.type, click.Path) and values.get(each.name or "") == "":
            raise click.BadParameter("an empty path.", ctx, each)
    names = {name for each in options for name in each.opts}
    for option in options:
        label, value = "/".join(option.opts), values.get(option.name or "")
        if (times := said.count(option)) > 1 and not (option.multiple or option.count):
            raise click.UsageError(f"{label} is given {times} times, and {command.name} takes one.", ctx)
        for each in value if isinstance(value, list) else [value]:
            if isinstance(each, str) and (each.startswith("--") or each in names):
                allowed = f"{option.make_metavar(ctx)}, a path that begins so as ./{each}"
                raise click.UsageError(f"{label} is followed by {each}; allowed: {allowed}", ctx)
    return None


class _Loading(MutableMapping[str, click.Command]):
    """Subcommands by name, each imported when it is first looked up."""

    def __init__(self, listed: Mapping[str, Listed]) -> None:
        self._listed: dict[str, Listed | click.Command] = dict(listed)

    def __getitem__(self, name: str) -> click.Command:
        found = self._listed[name]
        if isinstance(found, Listed):
            found = self._listed[name] = found.load()
        return found

    def __setitem__(self, name: str, command: click.Command) -> None:
        self._listed[name] = command

    def __delitem__(self, name: str) -> None:
        del self._listed[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._listed)

    def __len__(self) -> int:
        return len(self._listed)
