"""The options of commands that call the security service."""

import inspect
import sys
from collections.abc import Callable
from functools import wraps
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Concatenate, ParamSpec
from urllib.parse import urlsplit

import typer

from rtron.cli.support.outcome import Outcome

if TYPE_CHECKING:
    from rtron.workflows.service_client import SecurityServiceClient


ServiceOption = Annotated[
    str,
    typer.Option(
        "--service",
        metavar="URL",
        envvar="RTRON_SERVICE",
        help="The address of the security service.",
    ),
]
TokenOption = Annotated[
    Path | None,
    typer.Option(
        "--token-file",
        metavar="FILE",
        envvar="RTRON_TOKEN_FILE",
        help="Your token for the service; `rtron token create` makes one.",
    ),
]
RobotOption = Annotated[
    str,
    typer.Option(
        "--robot",
        metavar="NAME",
        envvar="RTRON_ROBOT",
        help="The robot; can be left out if there is only one.",
    ),
]
CaOption = Annotated[
    Path | None,
    typer.Option(metavar="FILE", help="The service's own certificate authority, as PEM."),
]
DEFAULT_SERVICE = "http://127.0.0.1:8600"
_P = ParamSpec("_P")
_LOOPBACK = ("localhost", "127.0.0.1", "::1")


def connect_to_service(
    service: str, token_file: Path | None, ca: Path | None
) -> "SecurityServiceClient":
    """Return a client; warn on standard error if its token crosses a network in clear."""
    from rtron.workflows.service_client import open_service_client

    client = open_service_client(service, token_file, ca)
    warn_if_unencrypted(service)
    return client


def warn_if_unencrypted(service: str) -> None:
    """Warn on standard error if a token for this address crosses a network in clear."""
    parts = urlsplit(service)
    if parts.scheme == "http" and parts.hostname not in _LOOPBACK:
        sys.stderr.write(f"warning: {service} is not encrypted: others can read the token\n")


def _connection_options(
    *, service: ServiceOption = DEFAULT_SERVICE, token_file: TokenOption = None, ca: CaOption = None
) -> "SecurityServiceClient":
    return connect_to_service(service, token_file, ca)


def calls_service(
    command: Callable[Concatenate["SecurityServiceClient", _P], Outcome],
) -> Callable[..., Outcome]:
    """Give a command the options of the connection, behind its own; it gets the client first."""
    connection = inspect.signature(_connection_options).parameters
    own = list(inspect.signature(command).parameters.values())[1:]

    @wraps(command)
    def run(*args: _P.args, **given: _P.kwargs) -> Outcome:
        client = _connection_options(**{name: given.pop(name) for name in connection})  # type: ignore[arg-type]
        return command(client, *args, **given)

    parameters = [*own, *connection.values()]
    run.__signature__ = inspect.Signature(parameters)  # type: ignore[attr-defined]
    run.__annotations__ = {each.name: each.annotation for each in parameters}
    return run
