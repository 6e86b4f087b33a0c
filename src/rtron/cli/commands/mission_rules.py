"""`rtron mission-rules`."""

from typing import TYPE_CHECKING, Annotated

import typer

from rtron.cli.support.outcome import Outcome
from rtron.errors import InputError, suggestion

if TYPE_CHECKING:
    from rich.text import Text


def _complete(incomplete: str) -> list[str]:
    from rtron.planning.missions import MISSIONS

    return [name for name in MISSIONS if name.startswith(incomplete)]


def mission_rules(
    name: Annotated[
        str | None,
        typer.Argument(metavar="NAME", help="The mission.", autocompletion=_complete),
    ] = None,
) -> Outcome:
    """Show example rules for a robot's mission; without a name, list them.

    Each is a complete plan: events, their meaning, and the actions that they
    forbid. Copy its rules.

    $ rtron mission-rules
    $ rtron mission-rules recharge
    $ rtron mission-rules recharge > rtron.yaml && rtron check rtron.yaml
    """
    from rtron.planning.missions import MISSIONS, mission_text
    from rtron.reports.text_layout import Report

    if name is None:
        return Outcome(Report(lambda _: _list_missions()))
    if name not in MISSIONS:
        raise InputError(f"no mission {name}", help=suggestion(name, MISSIONS))
    return Outcome(mission_text(name))


def _list_missions() -> "list[Text]":
    from rtron.planning.missions import MISSIONS, mission_summary
    from rtron.reports.text_layout import columns, line

    rows = [(name, mission_summary(name)) for name in MISSIONS]
    return [line(("Missions", "bold")), *columns(rows, ("cyan",), indent=2)]
