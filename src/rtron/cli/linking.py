"""The options of `rtron guard` that name the security service."""

import socket
import sys
from pathlib import Path
from typing import Annotated

import typer

from rtron.errors import InputError
from rtron.guard.link.options import LinkOptions, state_folder

ServiceUrl = Annotated[
    str,
    typer.Option(
        metavar="URL",
        envvar="RTRON_SERVICE",
        help="The security service, as `rtron serve` says it.",
    ),
]
TokenFile = Annotated[
    Path | None,
    typer.Option(
        metavar="FILE", envvar="RTRON_TOKEN_FILE", help="Where the token for the service stands."
    ),
]
Robot = Annotated[
    str,
    typer.Option(metavar="NAME", envvar="RTRON_ROBOT", help="What the service calls this robot."),
]
State = Annotated[
    Path | None,
    typer.Option(metavar="FOLDER", help="Where settings and waiting events are kept."),
]
CertificateAuthority = Annotated[
    Path | None,
    typer.Option(metavar="FILE", help="The service's own certificate authority, as PEM."),
]


def build_link_options(
    app: str,
    service: str,
    token_file: Path | None,
    robot: str,
    state: Path | None,
    ca: Path | None,
) -> LinkOptions:
    """Return the link's options, all of them checked; InputError if one cannot be used."""
    if token_file is None:
        help = "make one with `rtron token create`, and give --token-file FILE"
        raise InputError("--service without --token-file", help=help)
    options = LinkOptions(
        service=service,
        token_file=token_file.absolute(),
        robot=robot or socket.gethostname(),
        state=(state or state_folder(app)).absolute(),
        ca=ca.absolute() if ca else None,
    )
    options.token()
    options.prepare()
    if options.url and options.is_unencrypted:
        sys.stderr.write(f"warning: {service} is not encrypted: others can read the token\n")
    return options
