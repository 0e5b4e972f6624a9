"""The command line: ``vmach COMMAND``."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated, Any

import typer
from typer.core import TyperGroup

from vmach import __version__
from vmach.base.kernel_cache import (
    collect_less_often,
    find_room_for_kernels,
    forget_stale_kernels,
)
from vmach.commands.accuracy import accuracy
from vmach.commands.batch import batch
from vmach.commands.canon import canon
from vmach.commands.check import check
from vmach.commands.compensate import compensate
from vmach.commands.diagnosis import add, diagnose, history, set_job_values
from vmach.commands.effects import effects_app
from vmach.commands.features import features
from vmach.commands.importing import import_files
from vmach.commands.init import init
from vmach.commands.iso230 import iso230
from vmach.commands.machining import compare, run
from vmach.commands.open import open_workbench, view
from vmach.commands.path import path
from vmach.commands.predict import predict
from vmach.commands.schema import schema
from vmach.commands.tables import HelpWithFormats, tables
from vmach.commands.warm_up import compile_if_cold, warm_up
from vmach.errors import VmachError

__all__ = ["app", "main"]

_LONGEST_MESSAGE = 2000


class _Commands(TyperGroup):
    """The commands; what Typer would tell as a bare "Aborted!" goes on to `vmach.__main__`."""

    def invoke(self, ctx: Any) -> Any:
        try:
            return super().invoke(ctx)
        except EOFError as error:
            raise RuntimeError("a file ended too early") from error
        except typer.Abort:  # a question that nobody answers
            raise KeyboardInterrupt from None


app = typer.Typer(
    cls=_Commands,
    name="vmach",
    help="Predict the part that a real machine makes from an NC program.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,  # plain text: nothing of a command line is read as markup
    context_settings={"help_option_names": ["-h", "--help"]},
)


@app.callback(invoke_without_command=True)
def _before_any_command(
    context: typer.Context,
    version: Annotated[bool, typer.Option("--version", help="print the version")] = False,
    effect_file: Annotated[
        list[Path] | None,
        typer.Option(
            metavar="FILE",
            help="Python file with an effect of your own, for any command; repeatable",
        ),
    ] = None,
) -> None:
    if version:
        print(__version__)
        raise typer.Exit
    compile_if_cold(context.invoked_subcommand)
    for file in effect_file or []:
        from vmach.effects import load_effect_file

        load_effect_file(file)


app.command()(init)
app.command("import")(import_files)
for _command in (
    check,
    run,
    compare,
    features,
    predict,
    path,
    diagnose,
    add,
    history,
    compensate,
):
    app.command()(_command)
app.command("set")(set_job_values)
app.command("open")(open_workbench)
app.command(cls=HelpWithFormats)(tables)
for _command in (batch, accuracy, iso230, canon, schema, view, warm_up):
    app.command()(_command)
app.add_typer(effects_app, name="effects")


def main() -> None:
    """Run the command line; user errors become one message and exit status 1."""
    find_room_for_kernels()
    forget_stale_kernels()
    collect_less_often()
    try:
        app()
    except OSError as error:
        _complain(f"{error.filename or 'standard output'}: {error.strerror}")
    except VmachError as error:
        _complain(error)
    except ValueError as error:
        if not _is_about_the_input(error):
            raise
        _complain(error)


def _complain(what: object) -> None:
    text = str(what)
    if len(text) > _LONGEST_MESSAGE:  # it quotes a cell or a line without an end
        half = _LONGEST_MESSAGE // 2
        text = f"{text[:half]} [...] {text[-half:]}"
    print(f"vmach: {text}", file=sys.stderr)
    sys.exit(1)


def _is_about_the_input(error: ValueError) -> bool:
    """Whether it comes from a package below vmach, which have errors of their own."""
    from gcode import ProgramError
    from stock import StockError

    return isinstance(error, ProgramError | StockError)
