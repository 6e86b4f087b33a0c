"""What `rtron serve`, `rtron token` and `rtron user` share."""

import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from rtron.errors import InputError

if TYPE_CHECKING:
    from rtron.service.store.database import Database

DatabaseOption = Annotated[
    str,
    typer.Option(
        "--database",
        envvar="RTRON_DATABASE",
        metavar="FILE|URL",
        help="The service's database: a file, or postgresql://user@host/name.",
    ),
]
DEFAULT_DATABASE = "rtron.db"
OFFLINE_ACTOR = "rtron"
"""Who did it, in the audit log, when it was done on the database itself."""
_NEEDED = ("alembic", "argon2", "fastapi", "httpx", "prometheus_client", "sqlalchemy", "uvicorn")


def require_service_packages() -> None:
    """Raise InputError if the packages of the security service are not installed."""
    missing = [name for name in _NEEDED if find_spec(name) is None]
    if missing:
        help = 'pip install "rtron[service]"'
        raise InputError(f"the security service needs {', '.join(missing)}", help=help)


@contextmanager
def existing_database(database: str) -> "Iterator[Database]":
    """Give the database, brought up to date; InputError if it is not there."""
    require_service_packages()
    from rtron.service.server.database_setup import open_existing_database

    found = open_existing_database(database)
    try:
        yield found
    finally:
        found.close()


@contextmanager
def new_or_existing_database(database: str) -> "Iterator[Database]":
    """Give the database, made if it is not there, brought up to date."""
    require_service_packages()
    from rtron.service.server.database_setup import open_database

    found = open_database(database)
    try:
        yield found
    finally:
        found.close()


@contextmanager
def secret_writer(path: Path | None) -> Iterator[Callable[[str], str]]:
    """Give a function that keeps a secret in a new file for its owner alone; it says what to print.

    The file is made before the secret is; if that fails there is neither.
    """
    if path is None:
        yield lambda secret: f"{secret}\n"
        return
    _create_private_file(path)
    try:
        yield lambda secret: _write_secret(path, secret)
    except BaseException:
        path.unlink(missing_ok=True)
        raise


def _create_private_file(path: Path) -> None:
    try:
        os.close(os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600))
    except OSError as error:
        help = "give a new file in a folder that may be written"
        reason = error.strerror or "cannot be written"
        raise InputError(reason, path=str(path), help=help) from None


def _write_secret(path: Path, secret: str) -> str:
    path.write_text(secret + "\n", encoding="utf-8")
    return f"written to {path}, which only you can read\n"
