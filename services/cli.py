"""The `sdt` command."""

import sys
from importlib.metadata import version

import click

from sdt_kg.errors import InputError, SdtError
from services.commands import (
    achieve,
    ask,
    branch,
    bus,
    kitchens,
    learn,
    mcp,
    ontology,
    place,
    reason,
    recheck,
    robot,
    serve,
    table,
    task,
    whatif,
    why,
)

BAD_INPUT_EXIT = 2
NO_ORACLE_EXIT = 4
INTERRUPTED_EXIT = 130


@click.group(context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 110})
@click.version_option(version("sdt-kg"), prog_name="sdt")
def sdt() -> None:
    r"""Certify that a robot's body motion will achieve a task.

    A verdict is certified when three predicates hold: SatisfiesRequest (the final state meets the request),
    Causes (physics under the motion ends there) and CanPerform (the robot can do it inside its limits and
    without collision). Everything is relative to the class D_artic: outside it the answer is 'abstained'.

    \b
    Exit codes   0 done, all certified or in scope    2 bad input
                 1 some not certified                 3 abstained, out of scope
                 4 an oracle is unavailable
    """


for command in (
    kitchens.containers,
    kitchens.graph,
    kitchens.scope,
    ask.query,
    ask.satisfies,
    ask.causes,
    achieve.achieve,
    recheck.recheck,
    place.place,
    learn.learn_command,
    table.table,
    task.task_command,
    robot.robot,
    whatif.whatif,
    bus.ask,
    bus.oracle,
    bus.router,
    why.why_command,
    ontology.ontology_command,
    serve.serve,
    mcp.mcp_command,
    branch.branch,
    branch.diff,
    branch.patch,
    reason.reason,
):
    sdt.add_command(command)


def main() -> None:
    """Run `sdt`; a typed error becomes one line on standard error and an exit code."""
    try:
        sdt.main(standalone_mode=False)
    except click.ClickException as error:
        error.show()
        sys.exit(error.exit_code)
    except (click.Abort, KeyboardInterrupt):
        click.echo("interrupted: verdicts which were finished are saved", err=True)
        sys.exit(INTERRUPTED_EXIT)
    except SdtError as error:
        click.echo(f"error: {error}", err=True)
        sys.exit(BAD_INPUT_EXIT if isinstance(error, InputError) else NO_ORACLE_EXIT)
    except BrokenPipeError:
        sys.stderr.close()


if __name__ == "__main__":
    main()
