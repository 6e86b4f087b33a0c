"""A ROS 2 domain, and ports, that no other demo on this machine uses meanwhile."""

import socket
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from random import SystemRandom

from rtron.errors import SourceError

_DOMAINS = range(215, 232)
"""The upper ones of those that Linux leaves to ROS 2 (docs.ros.org: The ROS_DOMAIN_ID)."""
_PORTS = (20_000, 32_000)
"""Ports that are not ephemeral: Linux gives out those from 32768 on to whoever calls."""


def free_port() -> int:
    """Return a port of the loopback device at which nobody listens."""
    while True:
        port = SystemRandom().randrange(*_PORTS)
        with socket.socket() as free, suppress(OSError):
            free.bind(("127.0.0.1", port))
            return port


@contextmanager
def reserve_domain() -> Iterator[int]:
    """Give a domain id that no other demo has; SourceError if all are taken."""
    for domain in SystemRandom().sample(_DOMAINS, len(_DOMAINS)):
        with socket.socket(socket.AF_UNIX) as lock:
            try:
                lock.bind(f"\0rtron-demo-domain-{domain}")  # abstract: gone with the process
            except OSError:
                continue
            yield domain
            return
    raise SourceError("every ROS 2 domain is taken", help="end other runs of the demo")
