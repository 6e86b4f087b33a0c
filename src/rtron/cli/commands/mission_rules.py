"""`rtron mission-rules`."""

from typing import Annotated

import typer
from rich.text import Text

from rtron.cli.support.outcome import Outcome
from rtron.errors import InputError, suggestion
from rtron.planning.missions import MISSIONS, mission_summary, mission_text
from rtron.reports.text_layout import Report, columns, line


def _complete(incomplete: str) -> list[str]:
    return [name for name in MISSIONS if name.startswith(incomplete)]


def mission_rules(
    name: Annotated[
        str | None,
        typer.Argument(metavar="NAME", help="The mission.", autocompletion=_complete),
    ] = None,
) -> Outcome:
    """Show an example of rules for a robot's mission; without a name, list the examples.

    Each is a complete plan: events, their meaning, and the actions that they
    forbid. Copy its rules.

    $ rtron mission-rules
    $ rtron mission-rules recharge
    $ rtron mission-rules recharge > rtron.yaml && rtron check rtron.yaml
    """
    if name is None:
        return Outcome(Report(lambda _: _list_missions()))
    if name not in MISSIONS:
        raise InputError(f"no mission {name}", help=suggestion(name, MISSIONS))
    return Outcome(mission_text(name))


def _list_missions() -> list[Text]:
    rows = [(name, mission_summary(name)) for name in MISSIONS]
    return [line(("Missions", "bold")), *columns(rows, ("cyan",), indent=2)]
