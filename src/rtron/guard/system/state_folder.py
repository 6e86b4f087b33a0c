"""The files in which the guard of an app keeps what must outlive it."""

import ipaddress
import os
import socket
from pathlib import Path
from urllib.parse import urlsplit

_MOST = 64


def master_file_name(master: str) -> str:
    """Return the name of a file about a master or a domain, without its ending.

    The network is not asked, which may be down when a guard starts. So this machine is known by
    its loopback addresses and its host name; by other names it is another one.
    """
    return "".join(each if each.isalnum() else "_" for each in _canonical(master))[:_MOST]


def _canonical(master: str) -> str:
    try:
        parts = urlsplit(master)
        host, port = parts.hostname, parts.port
    except ValueError:
        return master
    if not host:
        return master
    return f"{parts.scheme}://{'localhost' if _is_this_machine(host) else host}:{port}"


def _is_this_machine(host: str) -> bool:
    own = socket.gethostname().lower()
    short = own.partition(".")[0]
    if host.rstrip(".") in ("localhost", own, short, f"{short}.local"):
        return True
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return False


INCIDENTS = "incidents"
"""The folder of incidents, in the folder of the guard's state."""


def state_folder(app: str) -> Path:
    """Return where the guard of an app keeps its state by default (XDG base folders)."""
    root = os.environ.get("XDG_STATE_HOME", "")
    base = Path(root) if Path(root).is_absolute() else Path.home() / ".local" / "state"
    name = "".join(each if each.isalnum() or each in "-_" else "_" for each in app)[:64] or "app"
    return base / "rtron" / name
