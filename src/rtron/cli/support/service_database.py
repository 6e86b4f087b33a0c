"""What `rtron serve`, `rtron token` and `rtron user` share."""

import os
from collections.abc import Callable, Iterator
from contextlib import closing, contextmanager
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
        help="The service's database: a file, or postgresql://user@host/name.  "
        "[default: rtron/rtron.db in XDG_STATE_HOME, or ~/.local/state]",
        show_default=False,
    ),
]
GroupOption = Annotated[
    list[str] | None,
    typer.Option(
        "--group",
        metavar="LABEL",
        help="Change only robots with this label; can be repeated.  [default: every robot]",
        show_default=False,
    ),
]
DEFAULT_DATABASE = ""
OFFLINE_ACTOR = "rtron"
"""Who did it, in the audit log, when it was done on the database itself."""
_NEEDED = (
    "alembic",
    "argon2",
    "authlib",
    "fastapi",
    "httpx",
    "prometheus_client",
    "segno",
    "sqlalchemy",
    "uvicorn",
)


def database_location(given: str) -> str:
    """Return the database that is given, or else the user's own (XDG base folders)."""
    root = Path(os.environ.get("XDG_STATE_HOME", ""))
    base = root if root.is_absolute() else Path.home() / ".local" / "state"
    return given or str(base / "rtron" / "rtron.db")


def prepare_database(given: str) -> str:
    """Return the database's location; the folder of the user's own is made, or InputError."""
    location = database_location(given)
    try:
        if not given:
            Path(location).parent.mkdir(mode=0o700, parents=True, exist_ok=True)
    except OSError as error:
        help = "give a file with --database"
        raise InputError(error.strerror or "no such folder", path=location, help=help) from None
    return location


def require_service_packages() -> None:
    """Raise InputError if the packages of the security service are not installed."""
    missing = [name for name in _NEEDED if find_spec(name) is None]
    if missing:
        help = 'pip install "rtron[service]"'
        raise InputError(f"the security service needs {', '.join(missing)}", help=help)


def existing_database(database: str) -> "closing[Database]":
    """Give the database, brought up to date; InputError if it is not there."""
    require_service_packages()
    from rtron.service.server.database_setup import open_existing_database

    return closing(open_existing_database(database_location(database)))


def new_or_existing_database(database: str) -> "closing[Database]":
    """Give the database, made if it is not there, brought up to date."""
    require_service_packages()
    from rtron.service.server.database_setup import open_database

    return closing(open_database(prepare_database(database)))


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
