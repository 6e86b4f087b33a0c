"""The arguments and options that several commands share."""

from enum import Enum
from pathlib import Path
from typing import Annotated

import typer

GraphPath = Annotated[
    Path | None,
    typer.Argument(metavar="GRAPH.json", help="The interaction graph; - is standard input."),
]
Live = Annotated[bool, typer.Option("--live", help="Read the app that is running instead.")]
Master = Annotated[
    str, typer.Option(envvar="ROS_MASTER_URI", metavar="URI", help="The ROS master of the app.")
]
Timeout = Annotated[
    float, typer.Option(min=0.1, metavar="S", help="Seconds to wait for each answer of the app.")
]
Lists = Annotated[
    Path | None,
    typer.Option(metavar="FILE", help="Your own message types and topic names for the rules."),
]
Output = Annotated[
    Path, typer.Option("--output", "-o", metavar="FILE", help="Write to a file; - prints.")
]
PlanOption = Annotated[Path, typer.Option("--plan", metavar="rtron.yaml", help="The plan.")]
DEFAULT_MASTER = "http://localhost:11311"
DEFAULT_TIMEOUT = 5.0


class TextOrJson(str, Enum):
    """For a person or for a program."""

    TEXT = "text"
    JSON = "json"
