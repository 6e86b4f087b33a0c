"""Letting DDS announce the guard often, so that the guard learns soon of whoever comes.

Two participants know each other when one has heard the other's announcement and answered. Fast DDS
repeats it every 3 s (its own default, `leaseAnnouncement`), Cyclone DDS every 30 s (SPDPInterval):
where the first ones are lost, an intruder and a driver may have met seconds before the guard hears
of the intruder.
"""

from __future__ import annotations

import logging
import os
import socket
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING

from rtron.wire.ros2.rmw_version import KILTED, Version, rmw_version

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, MutableMapping


log = logging.getLogger(__name__)

_FAST_DDS = "rmw_fastrtps"
_FILE = "FASTDDS_DEFAULT_PROFILES_FILE"
_FASTDDS_2_FILE = "FASTRTPS_DEFAULT_PROFILES_FILE"
_PROFILES = {
    _FILE: str(Path(__file__).with_name("announce.xml")),
    _FASTDDS_2_FILE: str(Path(__file__).with_name("announce_fastdds2.xml")),
}
"""Both say the same: each version refuses the other's spelling of the heartbeat's period."""


def enable_fast_announcements(environ: MutableMapping[str, str] = os.environ) -> bool:
    """Announce the participants made from now on ten times a second; tell whether that is so.

    Where the user has profiles of their own, these count: then intruders may be found later.
    """
    profile = environ.get(_FILE) or environ.get(_FASTDDS_2_FILE)
    if profile in _PROFILES.values():
        return True
    if profile:
        log.info("your profiles of Fast DDS count: intruders may be found up to 3 s later")
        return False
    name = _file_variable(rmw_version())
    environ[name] = _PROFILES[name]
    return True


def _file_variable(version: Version | None) -> str:
    """Return the variable that a release reads: before Kilted there is Fast DDS 2."""
    return _FASTDDS_2_FILE if version and version < KILTED else _FILE


def publishes_without_waiting(rmw: str, environ: Mapping[str, str] = os.environ) -> bool:
    """Tell whether a writer with a full history refuses a message at once, and does not wait.

    The profile says so. It counts where the user has none, in Fast DDS 3; Cyclone DDS has no such
    setting.
    """
    return rmw.startswith(_FAST_DDS) and environ.get(_FILE) == _PROFILES[_FILE]


_CYCLONE = "CYCLONEDDS_URI"
_CYCLONE_SETTINGS = (
    "<CycloneDDS><Domain><Discovery><SPDPInterval>100 ms</SPDPInterval></Discovery><Internal>"
    "<Watermarks><WhcAdaptive>false</WhcAdaptive><WhcHigh>1 GB</WhcHigh></Watermarks>"
    "</Internal></Domain></CycloneDDS>,"
)


def configure_cyclone(environ: MutableMapping[str, str] = os.environ) -> None:
    """Let Cyclone DDS announce the participants made from now on ten times a second.

    And let no writer wait for a reader that hangs: by default one waits while 500 kB are not
    acknowledged, although newer messages replace them. The user's own settings come behind and
    count.
    """
    if not environ.get(_CYCLONE, "").startswith(_CYCLONE_SETTINGS):
        environ[_CYCLONE] = _CYCLONE_SETTINGS + environ.get(_CYCLONE, "")


RECEIVE_BUFFER_BYTES = 1 << 22
"""What is asked for, bytes; the kernel gives no more than net.core.rmem_max."""
_DESCRIPTORS = Path("/proc/self/fd")


@contextmanager
def large_receive_buffers() -> Iterator[None]:
    """Give every datagram socket that is opened in this block room for a crowd of messages."""
    before = _sockets()
    yield
    for inode, descriptor in _sockets().items():
        if inode not in before:
            _enlarge_buffer(descriptor)


def _sockets() -> dict[str, int]:
    """Return the descriptors of all our sockets, by what they are."""
    found: dict[str, int] = {}
    with suppress(OSError):  # /proc is not readable here
        for each in _DESCRIPTORS.iterdir():
            with suppress(OSError):  # it was closed meanwhile
                found[str(each.readlink())] = int(each.name)
    return {what: descriptor for what, descriptor in found.items() if what.startswith("socket:")}


def _enlarge_buffer(descriptor: int) -> None:
    """Give a datagram socket room; it stays its owner's."""
    try:
        with socket.socket(fileno=os.dup(descriptor)) as sock:
            if sock.type == socket.SOCK_DGRAM:
                sock.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, RECEIVE_BUFFER_BYTES)
    except OSError as error:
        log.debug("a socket keeps the room it has: %s", error)
