"""`sdt completion`: the script that makes a shell complete."""

import click
from click.shell_completion import get_completion_class

from sdt_kg.errors import InputError
from services.commands.completion.shells import register

HOW = {
    "bash": "echo 'eval \"$(sdt completion bash)\"' >> ~/.bashrc",
    "zsh": "echo 'eval \"$(sdt completion zsh)\"' >> ~/.zshrc, behind compinit",
    "fish": "sdt completion fish > ~/.config/fish/completions/sdt.fish",
}


@click.command(epilog="\b\n" + "\n".join(HOW.values()))
@click.argument("shell", type=click.Choice(list(HOW)))
@click.pass_context
def completion(context: click.Context, shell: str) -> None:
    """Print what makes SHELL complete commands, options, kitchens, robots, containers and joints."""
    register()
    found = get_completion_class(shell)
    if found is None:
        raise InputError(f"'{shell}' is no shell that is known", allowed=", ".join(HOW))
    click.echo(found(context.find_root().command, {}, "sdt", "_SDT_COMPLETE").source())
