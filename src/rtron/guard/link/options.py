"""Where the security service is, and where the link keeps what must outlive it."""

import os
import ssl
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING
from urllib.parse import urlsplit, urlunsplit

from rtron.errors import InputError
from rtron.guard.system.durable_file import make_private_folder, replace_file
from rtron.guard.system.unix_socket import abstract_address, user_name

if TYPE_CHECKING:
    from rtron.guard.link.plan_folder import PlanFolder

_PATH = "/link/v1"
_SCHEMES = {"http": "ws", "https": "wss"}
_SHARED = Path("/dev/shm")  # noqa: S108 - the folders in it are checked


@dataclass(frozen=True, slots=True, kw_only=True)
class LinkOptions:
    """What a guard is told of the service; `ca` is the certificate of its own authority, if any.

    `certificate` and its `key` are what the guard itself shows, if the service asks for that.
    `state` is a folder of the guard's user, where settings and events that wait are kept.
    `report_command` is the program that writes the report of an incident, whose file follows.
    `plans` is where plans of roll-outs are kept; None: the guard takes none.
    """

    service: str
    token_file: Path
    robot: str
    state: Path
    ca: Path | None = None
    certificate: Path | None = None
    key: Path | None = None
    report_command: tuple[str, ...] = ()
    plans: "PlanFolder | None" = None

    def tls_context(self) -> ssl.SSLContext | None:
        """Return how the service is known, and what the guard shows; None without TLS.

        The files are read each time, as certificates are renewed. OSError if they cannot be used.
        """
        if urlsplit(self.service).scheme != "https":
            return None
        context = ssl.create_default_context(cafile=self.ca)
        if self.certificate:
            context.load_cert_chain(self.certificate, self.key)
        return context

    def check_tls(self) -> None:
        """Raise InputError if the files of TLS cannot be used."""
        help = "give --ca, --client-cert and --client-key as PEM files, the key without password"
        if (self.certificate is None) != (self.key is None):
            raise InputError("a certificate and its key belong together", help=help)
        if self.certificate and urlsplit(self.service).scheme != "https":
            raise InputError("a certificate is shown over https only", help="give https://…")
        try:
            self.tls_context()
        except OSError as error:  # ssl.SSLError is one
            raise InputError(f"TLS: {error}", help=help) from None

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
    def audit_heads_file(self) -> Path:
        """Where signed heads of the service's audit log are kept."""
        return self.state / "audit_heads.jsonl"

    @property
    def reported_incidents_file(self) -> Path:
        """Where the names of the incidents are kept that need no report any more."""
        return self.state / "reported_incidents"

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
                make_private_folder(folder)
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

    def replace_token(self, secret: str) -> None:
        """Write another secret into the token file, all of it or nothing; OSError if it cannot."""
        replace_file(self.token_file.resolve(), f"{secret}\n".encode())


_TOKEN_HELP = "make one: rtron token create NAME --scope guard --robot ROBOT --token-file FILE"  # noqa: S105 - a command
