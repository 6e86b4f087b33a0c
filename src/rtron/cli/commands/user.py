"""`rtron user`."""

from enum import Enum
from pathlib import Path
from typing import Annotated

import typer

from rtron.cli.support.outcome import Outcome
from rtron.cli.support.service_database import (
    DEFAULT_DATABASE,
    OFFLINE_ACTOR,
    DatabaseOption,
    existing_database,
    new_or_existing_database,
    secret_writer,
)

user = typer.Typer(name="user", no_args_is_help=True, help="Add users and reset passwords.")


class RoleOption(str, Enum):
    """A role of a user."""

    ADMIN = "admin"
    DEVELOPER = "developer"
    END_USER = "end_user"


Name = Annotated[str, typer.Argument(metavar="NAME", help="The user.")]
PasswordFile = Annotated[
    Path | None,
    typer.Option(metavar="FILE", help="Write it to this new file, mode 0600."),
]


@user.callback()
def user_group() -> None:
    """Add users and reset passwords in the service's database; the service need not run."""


@user.command()
def add(
    name: Name,
    *,
    role: Annotated[list[RoleOption], typer.Option(help="A role of the user; can be repeated.")],
    password_file: PasswordFile = None,
    database: DatabaseOption = DEFAULT_DATABASE,
) -> Outcome:
    """Add a user with a new password, and show the password once.

    It creates a missing database, so you can add the first admin before the
    first start of the service.

    $ rtron user add mary --role developer --role end_user

    Exit code: 0 added, 2 bad options or a name that is taken.
    """
    with new_or_existing_database(database) as db, secret_writer(password_file) as write_secret:
        from rtron.service.server.database_accounts import create_user_record

        return Outcome(
            write_secret(create_user_record(db, OFFLINE_ACTOR, name, [each.value for each in role]))
        )


@user.command()
def password(
    name: Name,
    *,
    password_file: PasswordFile = None,
    database: DatabaseOption = DEFAULT_DATABASE,
) -> Outcome:
    """Give a user a new password, and show the password once.

    This unlocks the user and ends the user's sessions.

    $ rtron user password admin

    Exit code: 0 done, 2 no such user.
    """
    with existing_database(database) as db, secret_writer(password_file) as write_secret:
        from rtron.service.server.database_accounts import reset_password

        return Outcome(write_secret(reset_password(db, OFFLINE_ACTOR, name)))
