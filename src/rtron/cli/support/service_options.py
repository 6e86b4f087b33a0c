"""The options of commands that call the security service."""

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated
from urllib.parse import urlsplit

import typer

from rtron.cli.support.options import share_options

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


calls_service = share_options(_connection_options, in_front=False)
"""Gives a command the options of the connection; it gets the client."""
