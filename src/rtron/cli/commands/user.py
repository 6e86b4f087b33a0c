"""`rtron user`."""

import sys
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
    Path | None, typer.Option(metavar="FILE", help="Write it to this new file, mode 0600.")
]


@user.callback()
def user_group() -> None:
    """Add users and reset passwords in the service's database; the service need not run."""


@user.command()
def add(
    name: Name,
    *,
    role: Annotated[list[RoleOption], typer.Option(help="A role of the user; can be repeated.")],
    group: GroupOption = None,
    password_file: PasswordFile = None,
    database: DatabaseOption = DEFAULT_DATABASE,
) -> Outcome:
    """Add a user with a new password, and show the password once.

    It creates a missing database, so you can add the first admin before the
    first start of the service.

    $ rtron user add mary --role developer --role end_user
    $ rtron user add tom --role end_user --group hall-a

    Exit code: 0 added, 2 bad options or a name that is taken.
    """
    with new_or_existing_database(database) as db, secret_writer(password_file) as write_secret:
        from rtron.service.server.database_accounts import create_user_record

        roles = [each.value for each in role]
        return Outcome(
            write_secret(create_user_record(db, OFFLINE_ACTOR, name, roles, group or None))
        )


@user.command()
def password(
    name: Name, *, password_file: PasswordFile = None, database: DatabaseOption = DEFAULT_DATABASE
) -> Outcome:
    """Give a user a new password, and show the password once.

    This unlocks the user and ends the user's sessions.

    $ rtron user password admin

    Exit code: 0 done, 2 no such user.
    """
    with existing_database(database) as db, secret_writer(password_file) as write_secret:
        from rtron.service.server.database_accounts import reset_password

        return Outcome(write_secret(reset_password(db, OFFLINE_ACTOR, name)))


@user.command()
def second_factor(
    name: Name,
    *,
    remove: Annotated[
        bool, typer.Option("--remove", help="Remove it: the user has lost the phone.")
    ] = False,
    database: DatabaseOption = DEFAULT_DATABASE,
) -> Outcome:
    """Enrol one-time codes as a user's second factor, or remove them.

    Shows a key to scan or to type into an authenticator app (TOTP), asks for its
    code, and then shows the recovery codes once. The user's sessions end.

    $ rtron user second-factor mary
    $ rtron user second-factor mary --remove

    Exit code: 0 done, 2 no such user, a wrong code, or there is one already.
    """
    with existing_database(database) as db:
        from rtron.service.server.database_accounts import (
            begin_second_factor,
            confirm_second_factor,
            reset_second_factor,
        )

        if remove:
            reset_second_factor(db, OFFLINE_ACTOR, name)
            return Outcome(f"{name} logs in with the password alone\n")
        _show_key(begin_second_factor(db, name), name)
        codes = confirm_second_factor(db, OFFLINE_ACTOR, name, sys.stdin.readline())
        return Outcome("\n".join(["recovery codes, each for one login:", *codes, ""]))


def _show_key(key: str, name: str) -> None:
    """Write the key to standard error, as a picture too where that is a terminal."""
    import segno

    from rtron.service.domain.one_time_codes import otpauth_uri

    uri = otpauth_uri(key, name)
    if sys.stderr.isatty():
        segno.make(uri, micro=False).terminal(out=sys.stderr, compact=True)
    sys.stderr.write(f"{uri}\nkey: {key}\ncode of the app: ")
    sys.stderr.flush()
