"""The command `rtron`."""

import sys
from io import TextIOWrapper
from typing import Annotated

import typer

from rtron import __version__
from rtron.cli.check import check
from rtron.cli.classify import classify
from rtron.cli.demo import demo
from rtron.cli.events import events
from rtron.cli.explain import explain
from rtron.cli.explain_class import explain_class
from rtron.cli.functions import functions
from rtron.cli.guard import guard
from rtron.cli.instrument import instrument
from rtron.cli.master import master
from rtron.cli.mission import mission
from rtron.cli.model import model
from rtron.cli.outcome import BAD_INPUT, Outcome, complain, deliver
from rtron.cli.override import override
from rtron.cli.plan import plan
from rtron.cli.replay import replay
from rtron.cli.scan import scan
from rtron.cli.schema import schema
from rtron.cli.serve import serve
from rtron.cli.settings import settings
from rtron.cli.survey import survey
from rtron.cli.token import token
from rtron.cli.upload import upload
from rtron.cli.user import user
from rtron.cli.verify import verify
from rtron.errors import RTronError

COMMANDS = {
    "From an app to a guarded app": (demo, scan, plan, check, instrument, replay, verify),
    "On the robot": (guard, master, override),
    "Security service": (serve, events, upload),
    "Study": (classify, explain_class, survey),
    "Reference": (explain, mission, schema),
}
GROUPS = {
    "Security service": (settings, token, user),
    "Study": (functions,),
    "Reference": (model,),
}

app = typer.Typer(
    name="rtron",
    no_args_is_help=True,
    rich_markup_mode="rich",
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)
for panel, commands in COMMANDS.items():
    for command in commands:
        app.command(rich_help_panel=panel)(command)
    for group in GROUPS.get(panel, ()):
        app.add_typer(group, rich_help_panel=panel)


def main() -> None:
    """Run the command line and end with its exit code; the one place where errors are shown."""
    if isinstance(sys.stdout, TextIOWrapper):
        sys.stdout.reconfigure(errors="backslashreplace")
    try:
        app(prog_name="rtron")
    except RTronError as error:
        complain(error)
        sys.exit(BAD_INPUT)


def _version(wanted: bool) -> None:  # noqa: FBT001 - typer hands over the option's value
    if wanted:
        deliver(Outcome(f"rtron {__version__}\n"))


@app.callback(result_callback=deliver)
def start(
    *,
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Show the version.")
    ] = False,
) -> None:
    """Find what the functions of a robot app can do to each other, and guard it while it runs.

    From an app to a guarded app:

    $ rtron scan src --launch pkg/app.launch     who can interfere with whom
    $ rtron plan src --launch pkg/app.launch -o rtron.yaml
    $ rtron check rtron.yaml               after you edited the plan
    $ rtron instrument app.launch --plan rtron.yaml -o guarded.launch
    $ rtron replay run.bag --plan rtron.yaml     what it would have done
    $ roslaunch guarded.launch             the app, guarded
    $ rtron verify --live                  is the guard really in the way?

    Completion of commands and names: rtron --install-completion
    """
