"""The configuration files of Zenoh: the router's, and those of the processes around it.

Zenoh checks what one session sends another where it comes in. A peer that takes connections would
have to be trusted to check; so all are clients of the router, which alone listens, and only by TLS.
Neither scouting nor gossip tells them of one another.
"""

import re
from collections.abc import Iterable
from dataclasses import dataclass
from ipaddress import ip_address
from pathlib import PurePath
from typing import Any

from rtron.errors import InputError
from rtron.security.access.rights import AppAccess
from rtron.security.zenoh.access_control import DomainKeys, access_control

_HOST = re.compile(r"(?=.{1,253}\Z)[A-Za-z0-9](?:[A-Za-z0-9-]|\.(?=[A-Za-z0-9]))*", re.ASCII)
_INTERFACE = re.compile(r"[^\s/:]{1,15}")
"""As Linux has it (dev_valid_name)."""
_ADDRESS = re.compile(
    r"(?:\[(?P<ipv6>[^\]]*)\]|(?P<host>[^:]*))(?::(?P<port>[0-9]{1,9}))?", re.ASCII
)
_PORT, _HIGHEST_PORT = 7447, 65535
_PATIENT_QUEUE = {"congestion_control": {"block": {"wait_before_close": 60_000_000}}}
"""In µs: a process waits a minute for a router that is busy before it gives its link up."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ZenohRouter:
    """Where the router of an app is: `host` is an address or a name, the same for all processes.

    Processes come in by `interfaces` only, if any are given.
    """

    host: str = "localhost"
    port: int = _PORT
    interfaces: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        if not _is_host(self.host):
            help = "give --router HOST:PORT, with a name or an address"
            raise InputError(f"{self.host!r} is no host", help=help)
        if not 0 < self.port <= _HIGHEST_PORT:
            raise InputError(f"{self.port} is no port", help=f"choose 1 to {_HIGHEST_PORT}")
        if not all(map(_INTERFACE.fullmatch, self.interfaces)):
            help = "`ip link` lists the interfaces"
            raise InputError(f"{self.interfaces} are no network interfaces", help=help)

    @property
    def endpoint(self) -> str:
        """The router's address as Zenoh writes it."""
        host = f"[{self.host}]" if ":" in self.host else self.host
        return f"tls/{host}:{self.port}"


@dataclass(frozen=True, slots=True, kw_only=True)
class TlsFiles:
    """The files that prove who a process is: absolute paths on the robot."""

    authority: PurePath
    certificate: PurePath
    key: PurePath


def parse_router(address: str, interfaces: Iterable[str] = ()) -> ZenohRouter:
    """Return the router at HOST, HOST:PORT or [IPV6]:PORT; InputError if it is no such address."""
    parts = _ADDRESS.fullmatch(address)
    host = (parts["ipv6"] or parts["host"]) if parts else address
    port = int(parts["port"] or _PORT) if parts else _PORT
    return ZenohRouter(host=host, port=port, interfaces=tuple(interfaces))


def _is_host(host: str) -> bool:
    """Tell whether something is the name or the address of one host."""
    try:
        address = ip_address(host)
    except ValueError:
        return _HOST.fullmatch(host) is not None
    return not address.is_unspecified and "%" not in host


def router_config(
    access: AppAccess, router: ZenohRouter, files: TlsFiles, domain: int
) -> dict[str, Any]:
    """Return the configuration of `rmw_zenohd` or `zenohd` for an app (ZENOH_ROUTER_CONFIG_URI)."""
    config = _config("router", files, "listen")
    config["listen"] = {"endpoints": [router.endpoint]}
    config["access_control"] = access_control(access, DomainKeys(domain), router.interfaces)
    return config


def session_config(router: ZenohRouter, files: TlsFiles) -> dict[str, Any]:
    """Return the configuration of one process (ZENOH_SESSION_CONFIG_URI).

    It waits for the router, and comes back to it, as long as it takes.
    """
    config = _config("client", files, "connect")
    config["connect"] = {
        "endpoints": [router.endpoint],
        "timeout_ms": -1,
        "exit_on_failure": False,
        "retry": {"period_init_ms": 100, "period_max_ms": 1000, "period_increase_factor": 2},
    }
    config["transport"]["link"]["tx"]["queue"] = _PATIENT_QUEUE
    return config


def _config(mode: str, files: TlsFiles, side: str) -> dict[str, Any]:
    """Return what router and processes have in common.

    It replaces that of rmw_zenoh as a whole, so what that sets for ROS stands here, too ("ROS
    setting" in DEFAULT_RMW_ZENOH_SESSION_CONFIG.json5): what is stored for late subscribers needs
    time stamps, and many nodes that start together need time. Shared memory is off, as there: the
    router could not keep a process of the same user from writing into it.
    """
    return {
        "mode": mode,
        "scouting": {"delay": 0, "multicast": {"enabled": False}, "gossip": {"enabled": False}},
        "timestamping": {"enabled": True},
        "queries_default_timeout": 600_000,
        "adminspace": {"enabled": False},
        "transport": {
            "unicast": {
                "open_timeout": 60_000,
                "accept_timeout": 60_000,
                "accept_pending": 10_000,
                "max_sessions": 10_000,
                "max_links": 1,
            },
            "link": {
                "protocols": ["tls"],
                "tx": {"lease": 60_000, "keep_alive": 2},
                "tls": _tls(files, side),
            },
            "shared_memory": {"enabled": False},
        },
    }


def _tls(files: TlsFiles, side: str) -> dict[str, Any]:
    return {
        "enable_mtls": True,
        "verify_name_on_connect": True,
        "close_link_on_expiration": True,
        "root_ca_certificate": str(files.authority),
        f"{side}_certificate": str(files.certificate),
        f"{side}_private_key": str(files.key),
    }
