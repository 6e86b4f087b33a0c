"""The commands of `rtron` by name: each is imported when it is called, not before.

A guard on a robot starts in half the time without the modules that read launch files.
"""

from functools import cache
from importlib import import_module
from typing import Any, cast

import typer
from typer.core import TyperCommand, TyperGroup
from typer.main import get_command, get_group

from rtron.cli.support.outcome import STANDARD_OUTPUTS, is_unread
from rtron.errors import SourceError

COMMANDS = {
    "From an app to a guarded app": {
        "demo": "Attack a simulated robot, without the guard and with it.",
        "scan": "Find what the nodes of an app can do to each other.",
        "plan": "Propose a plan: the coordination nodes for an app.",
        "check": "Check a plan that you edited.",
        "instrument": "Write a launch file that starts the app guarded.",
        "secure": "Write the keystore with which SROS2 keeps strangers out of a guarded app.",
        "remaps": "List the remaps that put the guard between the nodes of a plan.",
        "replay": "Play a recording through a plan: which messages pass, and which do not.",
        "verify": "Check that all guarded traffic of the running app passes through the guard.",
    },
    "On the robot": {
        "guard": "Run the guard: enforce a plan between the nodes of an app, until stopped.",
        "master": "Run the ROS master behind a proxy that rejects what the plan forbids.",
        "cell": "Run a node in a cell: a network of its own, into which only the guard leads.",
        "override": "Suspend an RSRCN or MSRCN for a limited time.",
        "clear": "Let the robot drive again after an intrusion.",
        "stop": "Stop the robot until a person releases it.",
        "release": "Release what has stopped the robot; without a source, list it.",
        "mcp": "Let a language model ask about a robot, and command it within its rights.",
    },
    "Security service": {
        "serve": "Run the security service: collector of the guards, API and console.",
        "events": "Show the events of guards: which flow has control, what was blocked and why.",
        "upload-graph": "Upload the interaction graph of a robot's app for the console.",
    },
    "Study": {
        "classify": "Find the robot functions of repositories.",
        "explain-function": "Explain why a repository has its functions.",
        "survey": "Scan every app below a folder, a whole distribution if you like.",
    },
    "Reference": {
        "explain": "Explain a rule or a policy; without a name, list them.",
        "mission-rules": "Show example rules for a robot's mission; without a name, list them.",
        "schema": "Print the JSON Schema of a plan, graph, configuration, or bridge.",
    },
}
"""The commands of each part of the help, with the first line of their own."""
GROUPS = {
    "On the robot": {
        "bridge": "Let web pages and programs take part, each with rights of its own.",
        "incident": "Show and export what a guard has saved.",
        "lease": "Show who is in command of a robot, and change it.",
    },
    "Security service": {
        "audit": "Check and export the audit log.",
        "rollout": "Change many robots in stages, and watch them.",
        "settings": "Show and change what a guard enforces.",
        "token": "Create and revoke API tokens.",
        "user": "Add users and reset passwords.",
    },
    "Study": {"functions": "Study the functions of robot apps."},
    "Reference": {"model": "Write models of known nodes."},
}
_MODULES = {
    "check": "plan",
    "clear": "override",
    "lease": "override",
    "stop": "override",
    "release": "override",
    "remaps": "instrument",
    "cell": "master",
    "mcp": "bridge",
    "mission-rules": "explain",
    "schema": "explain",
    "upload-graph": "events",
}
"""The modules that do not have the name of their command."""


def load_command(name: str) -> Any:  # noqa: ANN401 - a function with options of its own, or a group
    """Return what the module of a command defines under the command's name."""
    module_name = _MODULES.get(name, name.replace("-", "_"))
    return getattr(import_module(f"rtron.cli.commands.{module_name}"), name.replace("-", "_"))


@cache
def _build_command(name: str) -> TyperCommand | TyperGroup:
    loaded = load_command(name)
    built = get_group(loaded) if isinstance(loaded, typer.Typer) else _single_command(loaded)
    _show_plainly(built)
    return built


def _single_command(function: Any) -> Any:  # noqa: ANN401 - typer's types say less than it gives
    app = typer.Typer(add_completion=False)
    app.command()(function)
    return get_command(app)


def _show_plainly(command: Any) -> None:  # noqa: ANN401 - likewise
    """Keep the lines of a command's help as they are written, without rich, which loads slowly."""
    command.rich_markup_mode = None
    command.help = _keep_lines(command.help or "")
    for each in getattr(command, "commands", {}).values():
        _show_plainly(each)


def _keep_lines(help: str) -> str:
    return "\n\n".join(f"\b\n{paragraph}" for paragraph in help.split("\n\n"))


class _LazyCommand(TyperCommand):
    """A command that is imported when it is called; its name and summary are known before."""

    def make_context(self, *arguments: Any, **options: Any) -> typer.Context:  # noqa: ANN401 - typer's own
        return cast(
            "typer.Context", _build_command(self.name or "").make_context(*arguments, **options)
        )


class CommandGroup(TyperGroup):
    """`rtron` with its commands, which are imported when they are called."""

    def __init__(self, **options: Any) -> None:  # noqa: ANN401 - typer's own
        commands = {
            name: _LazyCommand(name, short_help=summary)
            for table in (COMMANDS, GROUPS)
            for summaries in table.values()
            for name, summary in summaries.items()
        }
        super().__init__(**options | {"commands": commands})
        self._has_options = True
        self.help = _keep_lines(self.help or "")

    def invoke(self, ctx: Any) -> Any:  # noqa: ANN401 - likewise
        """Run a command; typer would end without a word where any connection of it breaks."""
        try:
            return super().invoke(ctx)
        except BrokenPipeError as error:
            if any(map(is_unread, STANDARD_OUTPUTS)):
                raise
            help = "see whether what the command speaks to still runs"
            raise SourceError(f"a connection ended: {error}", help=help) from error

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:  # noqa: ANN401 - likewise
        """Read the options of `rtron` itself only where some are given: typer loads pydantic."""
        self._has_options = args[0].startswith("-") if args else not ctx.resilient_parsing
        try:
            return super().parse_args(ctx, args)
        finally:
            self._has_options = True

    def get_params(self, ctx: Any) -> list[Any]:  # noqa: ANN401 - likewise
        """Return the options of `rtron` itself, where they are read."""
        return super().get_params(ctx) if self._has_options else []

    def format_commands(self, ctx: Any, formatter: Any) -> None:  # noqa: ANN401, ARG002 - likewise
        """List the commands by part, with their summaries."""
        for part, commands in COMMANDS.items():
            with formatter.section(part):
                formatter.write_dl([*commands.items(), *GROUPS.get(part, {}).items()])
