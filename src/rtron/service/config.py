"""How the service is to run, checked before anything starts."""

import ipaddress
import os
from dataclasses import dataclass
from pathlib import Path

from rtron.errors import InputError
from rtron.service.domain.oidc import OidcConfig
from rtron.service.domain.principal import UserRole
from rtron.service.store.retention import RetentionLimits

_HOUR = 3_600_000_000_000
_MAX_HEADS_INTERVAL_S = 86_400
_DEFAULT_RETENTION = RetentionLimits(max_days=30, max_bytes=4 << 30)
_LOOPBACK = frozenset({"localhost", "127.0.0.1", "::1"})


@dataclass(frozen=True, slots=True, kw_only=True)
class Tls:
    """The certificate (with its chain) and its private key, both PEM."""

    cert: Path
    key: Path


@dataclass(frozen=True, slots=True, kw_only=True)
class ServiceConfig:
    """Where the service listens and keeps what; InputError if that is unsafe or impossible.

    `database` is a file or a URL. `allowed_hosts` are the names by which browsers and guards may
    call it, beside loopback. `proxies` are addresses or networks of reverse proxies, which must
    speak TLS to the outside. Guards show a certificate of `client_ca`, if there is one. Roles of
    `second_factor_roles` log in with a code. With `four_eyes`, what gives rights waits for a second
    admin. `session_idle_timeout` and `session_lifetime` are in ns. The key that signs the audit log
    is in `audit_folder`; signed heads go out every `heads_interval_s` seconds.
    """

    database: str | Path = Path("rtron.db")
    audit_dir: Path | None = None
    heads_interval_s: float = 60.0
    host: str = "127.0.0.1"
    port: int = 8600
    tls: Tls | None = None
    client_ca: Path | None = None
    allowed_hosts: tuple[str, ...] = ()
    proxies: tuple[str, ...] = ()
    allow_insecure_http: bool = False
    retention: RetentionLimits = _DEFAULT_RETENTION
    oidc: OidcConfig | None = None
    four_eyes: bool = False
    second_factor_roles: frozenset[UserRole] = frozenset()
    session_idle_timeout: int = 2 * _HOUR
    session_lifetime: int = 12 * _HOUR

    def __post_init__(self) -> None:
        _check_address(self)
        _check_retention(self.retention)
        if not 1 <= self.heads_interval_s <= _MAX_HEADS_INTERVAL_S:
            raise InputError("--heads-every is 1 to 86400 seconds", help="for example 60")
        for name in self.allowed_hosts:
            _check_host_name(name)
        for proxy in self.proxies:
            _check_proxy(proxy)
        if self.tls:
            _check_readable(self.tls.cert)
            _check_readable(self.tls.key)
        if self.client_ca:
            _check_client_ca(self)

    @property
    def audit_folder(self) -> Path:
        """The folder that is given, or one beside the database's file, or the user's own."""
        return self.audit_dir or default_audit_folder(str(self.database))

    @property
    def is_local(self) -> bool:
        """Whether only programs of the same machine can connect."""
        return self.host in _LOOPBACK

    @property
    def is_secure(self) -> bool:
        """Whether browsers see HTTPS: spoken here, or by the reverse proxy."""
        return self.tls is not None or bool(self.proxies)

    @property
    def host_names(self) -> frozenset[str]:
        """The host names that a request may be for, in small letters."""
        return _LOOPBACK | {name.lower() for name in (self.host, *self.allowed_hosts)}


def default_audit_folder(database: str) -> Path:
    """Return where the audit log's key is: beside a file, for a server in the user's state."""
    if "://" not in database:
        return Path(f"{database}.audit")
    root = Path(os.environ.get("XDG_STATE_HOME", ""))
    base = root if root.is_absolute() else Path.home() / ".local" / "state"
    return base / "rtron" / "audit"


def _check_address(config: ServiceConfig) -> None:
    if not 0 <= config.port <= 65535:  # noqa: PLR2004 - the range of ports
        raise InputError(f"--port {config.port} is not a port", help="choose one of 0 to 65535")
    _check_host_name(config.host)
    if not (config.is_local or config.tls or config.allow_insecure_http):
        raise InputError(
            f"{config.host} is not this machine alone, and there is no TLS",
            help="give --tls-cert and --tls-key; or --insecure-http, if the network is trusted: "
            "passwords, tokens and settings are then readable there",
        )


def _check_retention(retention: RetentionLimits) -> None:
    if not retention.max_days > 0:
        raise InputError("--keep-days must be more than 0", help="for example --keep-days 30")
    if retention.max_bytes < 1 << 20:
        raise InputError("--keep-mb must be 1 at least", help="for example --keep-mb 4096")


def _check_host_name(name: str) -> None:
    try:
        ipaddress.ip_address(name)
    except ValueError:
        parts = name.split(".")
        if not all(part and part.replace("-", "").isalnum() and part.isascii() for part in parts):
            help = "give a name or an address without scheme, port and brackets"
            raise InputError(f"{name!r} is not the name of a host", help=help) from None


def _check_proxy(proxy: str) -> None:
    try:
        ipaddress.ip_network(proxy)
    except ValueError:
        help = "for example --proxy 127.0.0.1, or --proxy 10.0.0.0/8; names are not looked up"
        raise InputError(f"--proxy {proxy!r} is no IP address or network", help=help) from None


def _check_client_ca(config: ServiceConfig) -> None:
    if not (config.tls or config.proxies):
        help = "give --tls-cert and --tls-key, or the --proxy that hands certificates on"
        raise InputError("--client-ca without TLS", help=help)
    assert config.client_ca  # noqa: S101 - as the caller has seen
    _check_readable(config.client_ca)


def _check_readable(path: Path) -> None:
    try:
        with path.open("rb"):
            return
    except OSError as error:
        help = "give a PEM file that this user may read"
        raise InputError(error.strerror or "cannot be read", path=str(path), help=help) from None
