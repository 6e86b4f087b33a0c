"""The commands of `rtron` by name: each is imported when it is called, not before.

A guard on a robot starts in half the time without the modules that read launch files.
"""

from collections.abc import Iterator, Mapping
from functools import cache
from importlib import import_module
from typing import Any

import typer
from typer.core import TyperCommand, TyperGroup
from typer.main import get_command, get_group

COMMANDS = {
    "From an app to a guarded app": (
        "demo",
        "scan",
        "plan",
        "check",
        "instrument",
        "remaps",
        "replay",
        "verify",
    ),
    "On the robot": ("guard", "master", "override", "clear"),
    "Security service": ("serve", "events", "upload-graph"),
    "Study": ("classify", "explain-function", "survey"),
    "Reference": ("explain", "mission-rules", "schema"),
}
GROUPS = {
    "Security service": ("settings", "token", "user"),
    "Study": ("functions",),
    "Reference": ("model",),
}
_MODULES = {"clear": "override"}
"""The modules that do not have the name of their command."""
_PANELS = {
    name: panel for table in (COMMANDS, GROUPS) for panel, names in table.items() for name in names
}


def load_command(name: str) -> Any:  # noqa: ANN401 - a function with options of its own, or a group
    """Return what the module of a command defines under the command's name."""
    module_name = _MODULES.get(name, name.replace("-", "_"))
    return getattr(import_module(f"rtron.cli.commands.{module_name}"), name.replace("-", "_"))


@cache
def _build_command(name: str) -> TyperCommand | TyperGroup:
    loaded = load_command(name)
    built = get_group(loaded) if isinstance(loaded, typer.Typer) else _single_command(loaded)
    built.rich_help_panel = _PANELS[name]
    return built


def _single_command(function: Any) -> Any:  # noqa: ANN401 - typer's types say less than it gives
    app = typer.Typer(add_completion=False, rich_markup_mode="rich")
    app.command()(function)
    return get_command(app)


class _LazyCommands(Mapping[str, Any]):
    """The commands by name; a command is imported when it is looked up."""

    def __getitem__(self, name: str) -> TyperCommand | TyperGroup:
        if name not in _PANELS:
            raise KeyError(name)
        return _build_command(name)

    def __contains__(self, name: object) -> bool:
        return name in _PANELS

    def __iter__(self) -> Iterator[str]:
        return iter(_PANELS)

    def __len__(self) -> int:
        return len(_PANELS)


class CommandGroup(TyperGroup):
    """`rtron` with its commands, which are imported when they are called."""

    def __init__(self, **options: Any) -> None:  # noqa: ANN401 - typer's own
        super().__init__(**options | {"commands": _LazyCommands()})
