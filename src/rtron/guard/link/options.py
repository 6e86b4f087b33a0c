"""Where the security service is, and where the link keeps what must outlive it."""

import os
from dataclasses import dataclass
from pathlib import Path
from urllib.parse import urlsplit, urlunsplit

from rtron.errors import InputError
from rtron.guard.system.unix_socket import abstract_address, user_name

_PATH = "/link/v1"
_SCHEMES = {"http": "ws", "https": "wss"}
_SHARED = Path("/dev/shm")  # noqa: S108 - the folders in it are checked


@dataclass(frozen=True, slots=True, kw_only=True)
class LinkOptions:
    """What a guard is told of the service; `ca` is the certificate of its own authority, if any.

    `state` is a folder of the guard's user, where settings and events that wait are kept.
    """

    service: str
    token_file: Path
    robot: str
    state: Path
    ca: Path | None = None

    @property
    def url(self) -> str:
        """Return the WebSocket address; InputError if the service's is none of http or https."""
        parts = urlsplit(self.service)
        if parts.scheme not in _SCHEMES or not parts.hostname:
            help = "give the address of `rtron serve`, for example https://robots.example:8600"
            raise InputError(f"{self.service!r} is no address of a service", help=help)
        return urlunsplit(
            (_SCHEMES[parts.scheme], parts.netloc, parts.path.rstrip("/") + _PATH, "", "")
        )

    @property
    def address(self) -> bytes:
        """The link process's own address (an abstract one, unix(7)), and so the lock on `state`."""
        return abstract_address(self._name)

    @property
    def _name(self) -> str:
        return user_name("link", os.fsencode(self.state.resolve()))

    @property
    def settings_file(self) -> Path:
        """Where the last settings are kept."""
        return self.state / "settings.json"

    @property
    def spool_file(self) -> Path:
        """Where events wait until the service has them."""
        return self.state / "events.sqlite"

    @property
    def counter_folder(self) -> Path:
        """Where each life of the guard counts its events.

        In memory (shm_overview(7)): a page of a file on a disk that is being flushed makes whoever
        writes to it wait, for tens of milliseconds.
        """
        return (_SHARED if _SHARED.is_dir() else self.state) / self._name

    def prepare(self) -> None:
        """Make the folders; InputError if they cannot be used."""
        try:
            for folder in (self.state, self.counter_folder):
                folder.mkdir(mode=0o700, parents=True, exist_ok=True)
                folder.chmod(0o700)
        except OSError as error:
            help = "choose a folder of your own with --state-dir"
            raise InputError(f"{error.filename}: {error.strerror}", help=help) from None

    def token(self) -> str:
        """Return the secret in the token file; InputError if there is none."""
        try:
            text = self.token_file.read_text().strip()
        except (OSError, ValueError) as error:
            raise InputError(f"{self.token_file}: {error}", help=_TOKEN_HELP) from None
        if not text or not text.isprintable() or " " in text:
            raise InputError(f"{self.token_file} holds no token", help=_TOKEN_HELP)
        return text


_TOKEN_HELP = "make one: rtron token create NAME --scope guard --robot ROBOT --token-file FILE"  # noqa: S105 - a command


def state_folder(app: str) -> Path:
    """Return where the guard of an app keeps its state by default (XDG base folders)."""
    root = os.environ.get("XDG_STATE_HOME", "")
    base = Path(root) if Path(root).is_absolute() else Path.home() / ".local" / "state"
    name = "".join(each if each.isalnum() or each in "-_" else "_" for each in app)[:64] or "app"
    return base / "rtron" / name
