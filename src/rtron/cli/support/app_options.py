"""The options of commands that read an app: from source, a graph, a bag, or running."""

from collections.abc import Callable
from functools import wraps
from inspect import Parameter, signature
from typing import TYPE_CHECKING, Any, TypeAlias

from rtron.cli.support.options import (
    DEFAULT_MASTER,
    Domain,
    Env,
    EnvAll,
    Inputs,
    Jobs,
    Launches,
    Live,
    LiveTimeout,
    Master,
    NoCache,
    RosOption,
)
from rtron.cli.support.outcome import Outcome
from rtron.workflows.live_app import LiveApp, RosGeneration

if TYPE_CHECKING:
    from rtron.workflows.app_selection import AppSelection

Command: TypeAlias = Callable[..., Outcome]


def with_app_options(command: Command) -> Command:
    """Give a command the options of `_app_selection` in place of its parameter `selection`."""
    shared = signature(_app_selection).parameters

    @wraps(command)
    def run(**values: Any) -> Outcome:  # noqa: ANN401 - as typer has parsed them
        selection = _app_selection(**{name: values.pop(name) for name in shared})
        return command(selection, **values)

    own = [each for name, each in signature(command).parameters.items() if name != "selection"]
    parameters: list[Parameter] = [*shared.values(), *own]
    run.__signature__ = signature(command).replace(parameters=parameters)  # type: ignore[attr-defined]
    run.__annotations__ = {each.name: each.annotation for each in parameters}
    return run


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
