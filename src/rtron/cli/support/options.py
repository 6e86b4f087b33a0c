"""The arguments and options that several commands share."""

from collections.abc import Callable
from enum import Enum
from functools import wraps
from inspect import Signature, signature
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, TypeAlias

import typer

from rtron.cli.support.outcome import Outcome
from rtron.errors import RTronError
from rtron.wire.ros2.domain_id import LAST_DOMAIN
from rtron.workflows.live_app import ANSWER_TIMEOUT_S, LiveApp, RosGeneration

if TYPE_CHECKING:
    from rtron.workflows.app_selection import AppSelection


def complete_launch(ctx: typer.Context, incomplete: str) -> list[str]:
    """Return the names of launch files for a shell's completion."""
    from rtron.workflows.source_app import launches_by_name

    inputs = ctx.params.get("inputs") or ctx.args or ["."]
    folders = [Path(word) for word in inputs if Path(word).is_dir()]
    try:
        names = launches_by_name(folders)
    except (RTronError, OSError):
        return []
    return [name for name in names if name.startswith(incomplete)]


Inputs = Annotated[
    list[str] | None,
    typer.Argument(
        metavar="PATH|GRAPH.json|BAG [ARG:=VALUE]",
        help="The app's source folders, a launch file in its package, its interaction graph (- is "
        "standard input), or a bag: .bag, .mcap, .db3, or a ROS 2 bag's folder. Arguments are for "
        "every launch file.",
    ),
]
Launches = Annotated[
    list[str] | None,
    typer.Option(
        "--launch",
        metavar="PKG/FILE",
        help="A launch file that starts the app, `pkg/file.launch` or a path; can be repeated. "
        "Arguments in the same word are for it alone: 'pkg/file.launch x:=1'.",
        autocompletion=complete_launch,
    ),
]
Env = Annotated[
    list[str] | None,
    typer.Option(
        "--env",
        metavar="NAME[=VALUE]",
        help="A variable of the app's environment, by default with the value that it has here; "
        "can be repeated. Of your environment nothing else counts but ROS_PACKAGE_PATH and "
        "AMENT_PREFIX_PATH.",
    ),
]
EnvAll = Annotated[
    bool, typer.Option("--env-all", help="Your whole environment is the app's, as at a launch.")
]
Jobs = Annotated[
    int | None,
    typer.Option(
        "--jobs", "-j", min=1, metavar="N", help="Work in N processes; no more than cores."
    ),
]
NoCache = Annotated[bool, typer.Option("--no-cache", help="Neither read nor write the cache.")]
Live = Annotated[bool, typer.Option("--live", help="Read the running app instead.")]
Master = Annotated[
    str, typer.Option(envvar="ROS_MASTER_URI", metavar="URI", help="The ROS master of the app.")
]
RosOption = Annotated[
    RosGeneration,
    typer.Option(
        help="The ROS of the running app. auto: ROS_VERSION, as a sourced ROS sets it, else a "
        "master that answers (1) or an installed rclpy (2)."
    ),
]
Domain = Annotated[
    int | None,
    typer.Option(
        min=0,
        max=LAST_DOMAIN,
        metavar="ID",
        help="The ROS 2 domain of the app.  [default: ROS_DOMAIN_ID, or 0]",
        show_default=False,
    ),
]
Timeout = Annotated[
    float, typer.Option(min=0.1, metavar="S", help="Seconds to wait for each answer of the app.")
]
LiveTimeout = Annotated[
    float | None,
    typer.Option(
        min=0.1,
        metavar="S",
        help="Seconds to wait: in ROS 1 for each answer, in ROS 2 until all nodes are found.  "
        "[default: 5, in ROS 2 15]",
        show_default=False,
    ),
]
NameLists = Annotated[
    Path | None,
    typer.Option(metavar="FILE", help="Your own message types and topic names for the rules."),
]
Output = Annotated[
    Path, typer.Option("--output", "-o", metavar="FILE", help="The file to write; - prints.")
]
PlanOption = Annotated[Path, typer.Option("--plan", metavar="rtron.yaml", help="The plan.")]
DEFAULT_MASTER = "http://localhost:11311"
DEFAULT_TIMEOUT = ANSWER_TIMEOUT_S


Readmes = Annotated[
    Path | None,
    typer.Option(
        metavar="FILE.jsonl", help="A line `{repo, readme}` for repositories without a README."
    ),
]


class TextOrJson(str, Enum):
    """Text for people, or JSON for programs."""

    TEXT = "text"
    JSON = "json"


Command: TypeAlias = Callable[..., Outcome]


def share_options(make: Callable[..., Any], *, in_front: bool) -> Callable[[Command], Command]:
    """Give commands the options of `make`; the first parameter of each gets what it returns.

    They stand in front of the command's own, or behind them.
    """
    shared = signature(make).parameters

    def decorate(command: Command) -> Command:
        @wraps(command)
        def run(**values: Any) -> Outcome:  # noqa: ANN401 - as typer has parsed them
            made = make(**{name: values.pop(name) for name in shared})
            return command(made, **values)

        own = list(signature(command).parameters.values())[1:]
        parameters = [*shared.values(), *own] if in_front else [*own, *shared.values()]
        run.__signature__ = Signature(parameters)  # type: ignore[attr-defined]
        run.__annotations__ = {each.name: each.annotation for each in parameters}
        return run

    return decorate


def _app_selection(  # noqa: PLR0913 - one for each option
    inputs: Inputs = None,
    *,
    launch: Launches = None,
    env: Env = None,
    env_all: EnvAll = False,
    live: Live = False,
    master: Master = DEFAULT_MASTER,
    ros: RosOption = RosGeneration.AUTO,
    domain: Domain = None,
    timeout: LiveTimeout = None,
    jobs: Jobs = None,
    no_cache: NoCache = False,
) -> "AppSelection":
    from rtron.workflows.app_selection import AppSelection, with_launch_paths
    from rtron.workflows.source_app import SourceOptions

    source = SourceOptions(
        launches=launch or (),
        env=env or (),
        env_all=env_all,
        jobs=jobs,
        use_cache=not no_cache,
    )
    running = LiveApp(ros=ros, master=master, domain=domain, timeout=timeout)
    given = AppSelection(inputs=inputs or (), live=running if live else None, source=source)
    return with_launch_paths(given)


with_app_options = share_options(_app_selection, in_front=True)
"""Gives a command the options that choose an app."""
