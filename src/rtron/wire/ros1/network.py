"""Where connections of ROS 1 are made: on this host, or in a network namespace beside it."""

import logging
import os
import socket
from collections.abc import Mapping
from typing import Protocol

log = logging.getLogger(__name__)

NETLINK_SOCK_DIAG = 4
"""linux/netlink.h"""


class Network(Protocol):
    """Makes the sockets of nodes; a socket belongs to one network for good."""

    def connect(self, address: tuple[str, int], timeout: float) -> socket.socket:
        """Return a connection, made within `timeout` seconds. OSError if there is none."""

    def listen(self, host: str, port: int, backlog: int) -> socket.socket:
        """Return a socket that listens; port 0 is a free one. OSError if it cannot."""

    def open_diag(self) -> socket.socket | None:
        """Return a socket to ask the kernel about connections with (sock_diag(7)), if there is one.

        It does not block.
        """


class HostNetwork:
    """The network that this process is in."""

    def connect(self, address: tuple[str, int], timeout: float) -> socket.socket:
        """See `Network`."""
        return socket.create_connection(address, timeout)

    def listen(self, host: str, port: int, backlog: int) -> socket.socket:
        """See `Network`."""
        return socket.create_server((host, port), backlog=backlog)

    def open_diag(self) -> socket.socket | None:
        """See `Network`."""
        try:
            diag = socket.socket(socket.AF_NETLINK, socket.SOCK_DGRAM, NETLINK_SOCK_DIAG)
        except OSError as error:
            log.info("whether nodes here read what they get is not known: %s", error)
            return None
        diag.settimeout(0)
        return diag


HOST_NETWORK = HostNetwork()


DEFAULT_MASTER = "http://localhost:11311"


def master_uri(environ: Mapping[str, str] = os.environ) -> str:
    """Return the master's address: ROS_MASTER_URI, or ROS's own default."""
    return environ.get("ROS_MASTER_URI") or DEFAULT_MASTER


def advertised_host(environ: Mapping[str, str] = os.environ) -> str:
    """Return the host that others are told: ROS_HOSTNAME, ROS_IP, or this machine's name."""
    override = environ.get("ROS_HOSTNAME") or environ.get("ROS_IP")
    if override:
        return override
    name = socket.gethostname()
    return name if _resolves(name) else "127.0.0.1"


def bind_address(host: str) -> str:
    """Return the address to listen on: loopback if that is where we are known, else all."""
    return "127.0.0.1" if host == "localhost" or host.startswith("127.") else ""


def _resolves(name: str) -> bool:
    try:
        socket.getaddrinfo(name, None, socket.AF_INET)
    except (OSError, UnicodeError):  # a label over 63 bytes is a UnicodeError
        return False
    return True
