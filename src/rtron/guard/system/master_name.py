"""One name for a master, however it is spelled: files that outlive a guard are named by it."""

import ipaddress
import socket
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
