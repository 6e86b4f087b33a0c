"""`rtron token`."""

from enum import Enum
from pathlib import Path
from typing import Annotated

import typer

from rtron.cli.support.outcome import Outcome
from rtron.cli.support.service_database import (
    DEFAULT_DATABASE,
    OFFLINE_ACTOR,
    DatabaseOption,
    GroupOption,
    existing_database,
    secret_writer,
)
from rtron.cli.support.service_options import (
    DEFAULT_SERVICE,
    CaOption,
    ServiceOption,
    TokenOption,
    connect_to_service,
)

token = typer.Typer(name="token", no_args_is_help=True, help="Create and revoke API tokens.")


class TokenScope(str, Enum):
    """A right of a token."""

    GUARD = "guard"
    METRICS = "metrics"
    READ = "read"
    END_USER = "end_user"
    DEVELOPER = "developer"
    ADMIN = "admin"


Name = Annotated[str, typer.Argument(metavar="NAME", help="The name of the token.")]


@token.callback()
def token_group() -> None:
    """Create and revoke API tokens in the service's database; the service need not run."""


@token.command()
def create(
    name: Name,
    *,
    scope: Annotated[list[TokenScope], typer.Option(help="A right of the token; can be repeated.")],
    robot: Annotated[
        str | None, typer.Option(metavar="NAME", help="The robot of the guard.")
    ] = None,
    days: Annotated[
        int, typer.Option(min=1, max=3650, metavar="DAYS", help="Days until it expires.")
    ] = 90,
    group: GroupOption = None,
    token_file: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Write it to this new file, mode 0600.")
    ] = None,
    database: DatabaseOption = DEFAULT_DATABASE,
) -> Outcome:
    """Create a token for a guard or a program, and show its secret once.

    A guard's token is valid for the link of one robot only. The guard renews it
    before its end, in its file; for a program, see `rtron token renew`.

    $ rtron token create car1 --scope guard --robot car1 --token-file car1.token
    $ rtron token create prometheus --scope metrics --days 365

    Exit code: 0 created, 2 bad options or a name that is taken.
    """
    with existing_database(database) as db, secret_writer(token_file) as write_secret:
        from rtron.service.server.database_accounts import create_token_record

        scopes = [each.value for each in scope]
        request = {"name": name, "scopes": scopes, "robot": robot, "days": days}
        request |= {"groups": group or None}
        return Outcome(write_secret(create_token_record(db, OFFLINE_ACTOR, request)))


@token.command()
def revoke(name: Name, *, database: DatabaseOption = DEFAULT_DATABASE) -> Outcome:
    """Revoke a token.

    $ rtron token revoke car1

    Exit code: 0 revoked, 2 no such token.
    """
    with existing_database(database) as db:
        from rtron.service.server.database_accounts import revoke_token_record

        revoke_token_record(db, OFFLINE_ACTOR, name)
    return Outcome(f"{name} is revoked\n")


@token.command()
def renew(
    *, service: ServiceOption = DEFAULT_SERVICE, token_file: TokenOption = None, ca: CaOption = None
) -> Outcome:
    r"""Renew the token in a file, for as long as it was made for.

    The file gets a new secret, and the old one is worthless from then on. A cron
    job does this for programs; guards do it themselves.

    $ rtron token renew --service https://robots.example:8600 \
          --token-file prometheus.token

    Exit code: 0 renewed, 2 the token is over or its file cannot be replaced.
    """
    from rtron.workflows.service_client import renew_token_file

    client = connect_to_service(service, token_file, ca)
    if token_file is None:
        raise AssertionError("there is no client without a token")
    return Outcome(renew_token_file(client, token_file))
