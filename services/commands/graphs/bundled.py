"""The queries that come with the ontology: listed, and found by name."""

import os
from pathlib import Path

import click
from click.shell_completion import CompletionItem

import ontology
from services.commands.show import print_rows

COLUMNS = ("query", "question", "known")


class QueryFile(click.Path):
    """A file with a query, or one that comes with the ontology: its name, or how no other begins."""

    def __init__(self) -> None:
        super().__init__(exists=True, dir_okay=False, path_type=Path)

    def convert(
        self, value: str | os.PathLike[str], param: click.Parameter | None, ctx: click.Context | None
    ) -> Path:
        """The file."""
        if Path(value).exists():
            return Path(os.fsdecode(super().convert(value, param, ctx)))
        known, begins = bundled_queries(), os.fsdecode(value)
        found = [name for name in known if name.startswith(begins)]
        if len(found) == 1 or begins in found:
            return known[begins if begins in found else found[0]]
        said = f"{', '.join(found)} begin so" if found else "no query that comes with sdt begins so"
        return self.fail(f"there is no file '{value}', and {said}: sdt query --list", param, ctx)

    def shell_complete(
        self, ctx: click.Context, param: click.Parameter, incomplete: str
    ) -> list[CompletionItem]:
        """Names of queries; files where none begins so."""
        del ctx, param
        found = [CompletionItem(name) for name in bundled_queries() if name.startswith(incomplete)]
        return found or [CompletionItem(incomplete, type="file")]


def bundled_queries() -> dict[str, Path]:
    """Name → file."""
    return {each.stem: each for each in sorted(ontology.path("queries").glob("*.rq"))}


def print_bundled(*, as_json: bool) -> None:
    """Each query with what may be said as known, and what it asks."""
    from services.ontology_page.read import queries  # noqa: PLC0415 - slow to import, and only listed here

    heads = {each.name: {fact.name: fact.values[0] for fact in each.head} for each in queries("queries/*.rq")}
    rows = [
        {"query": name, "known": heads[name]["Known"], "question": heads[name]["Question"]}
        for name in bundled_queries()
    ]
    print_rows(rows, COLUMNS, as_json=as_json)
