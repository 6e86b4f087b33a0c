"""Settings of DDS for RTron's own participants: found soon, and held up by nobody.

Two participants know each other when one has heard the other's announcement and answered. Fast DDS
repeats it every 3 s (its own default, `leaseAnnouncement`), Cyclone DDS every 30 s (SPDPInterval):
where the first ones are lost, an intruder and a driver may have met seconds before the guard hears
of the intruder.

A participant of Fast DDS that uses shared memory opens the other's part of it when they meet; where
the other has not been seen alive just then it waits 333 ms, and hears and sends nothing meanwhile
(`healthy_check` of its SharedMemGlobal.hpp). So what carries commands uses UDP alone.
"""

from __future__ import annotations

import json
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
_USERS_TRANSPORTS = "FASTDDS_BUILTIN_TRANSPORTS"
_RANGE, _ONLY_LOCALHOST = "ROS_AUTOMATIC_DISCOVERY_RANGE", "ROS_LOCALHOST_ONLY"
_USERS_RANGE = "RTRON_USERS_DISCOVERY_RANGE"
_LOOPBACK_UDP = "loopback_udp"
_PROFILES = Path(__file__).with_name("fastdds_profiles")
"""Those of Fast DDS 2 and 3 say the same: each refuses the other's spelling of the heartbeat's
period."""


def configure_fast_dds(
    rmw: str, *, shares_memory: bool | None = None, environ: MutableMapping[str, str] = os.environ
) -> bool:
    """Give the participants that this process makes from now on a profile; tell whether they have.

    Fast DDS reads it once, before the first of them. With `shares_memory` None it is that of the
    process that started this one, if that has one of ours. Where the user has profiles, these
    count: then intruders may be found later.
    """
    if not rmw.startswith(_FAST_DDS):
        return False
    path = environ.get(_FILE) or environ.get(_FASTDDS_2_FILE) or ""
    if path and not _is_ours(path):
        log.info("your profiles of Fast DDS count: intruders may be found up to 3 s later")
        return False
    if not path or shares_memory is not None:
        name = _file_variable(rmw_version())
        version = "fastdds_2" if name == _FASTDDS_2_FILE else "fastdds_3"
        _restore_range(environ)
        transport = _choose_transport(environ, shares_memory=shares_memory is not False)
        if transport == _LOOPBACK_UDP:
            _widen_range(environ)
        environ[name] = str(_PROFILES / version / f"{transport}.xml")
    return True


def _choose_transport(environ: Mapping[str, str], *, shares_memory: bool) -> str:
    """Return the profile of a process."""
    if shares_memory or environ.get(_USERS_TRANSPORTS):
        return "any_transport"
    stays = environ.get(_ONLY_LOCALHOST) == "1" or environ.get(_RANGE) == "LOCALHOST"
    return _LOOPBACK_UDP if stays else "udp"


def _widen_range(environ: MutableMapping[str, str]) -> None:
    """Have the profile alone keep discovery on this machine.

    Where the environment does, the RMW of Kilted adds shared memory to what a profile names.
    """
    users = {each: environ.get(each, "") for each in (_RANGE, _ONLY_LOCALHOST)}
    environ[_USERS_RANGE] = json.dumps(users)
    environ[_RANGE], environ[_ONLY_LOCALHOST] = "SUBNET", "0"


def _restore_range(environ: MutableMapping[str, str]) -> None:
    """Undo `_widen_range`, of this process or of the one that started it."""
    for name, value in json.loads(environ.pop(_USERS_RANGE, "{}")).items():
        environ[name] = value
        if not value:
            del environ[name]


def _is_ours(path: str) -> bool:
    return _PROFILES in Path(path).parents


def _file_variable(version: Version | None) -> str:
    """Return the variable that a release reads: before Kilted there is Fast DDS 2."""
    return _FASTDDS_2_FILE if version and version < KILTED else _FILE


def publishes_without_waiting(rmw: str, environ: Mapping[str, str] = os.environ) -> bool:
    """Tell whether a writer with a full history refuses a message at once, and does not wait.

    The profile says so. It counts where the user has none, in Fast DDS 3; Cyclone DDS has no such
    setting.
    """
    return rmw.startswith(_FAST_DDS) and _is_ours(environ.get(_FILE, ""))


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
