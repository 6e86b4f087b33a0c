"""Under which name a node of ours can be reached (ROS wiki: ROS/EnvironmentVariables)."""

import os
import socket
from collections.abc import Mapping

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
