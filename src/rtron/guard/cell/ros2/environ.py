"""The environment and the files of a node in a cell of ROS 2.

Nothing in the environment leads DDS out, nor another way in.
"""

import shutil
from collections.abc import Mapping, Sequence
from itertools import pairwise
from pathlib import Path

from rtron.errors import InputError
from rtron.wire.ros2.domain_id import domain_at

_LEFT = (
    "FASTDDS_",
    "FASTRTPS_",
    "RMW_",
    "RTRON_USERS_DISCOVERY_RANGE",
    "CYCLONEDDS_",
    "ZENOH_",
    "ROS_DISCOVERY_SERVER",
    "ROS_LOCALHOST_ONLY",
    "ROS_LOG_DIR",
    "ROS_SECURITY_",
    "ROS_STATIC_PEERS",
    "ROS_SUPER_CLIENT",
)
"""What begins like this stays outside: profiles, peers and transports are for another network."""
_RANGE = "ROS_AUTOMATIC_DISCOVERY_RANGE"
_FAST_DDS = {
    _RANGE: "SUBNET",
    "FASTDDS_BUILTIN_TRANSPORTS": "UDPv4",
    "SKIP_DEFAULT_XML": "1",
}
"""The cell has `lo` alone; without shared memory a file of another cell could not even be tried.

Shared memory would not work either, since the node has another user than the carriers. Under
LOCALHOST rmw_fastrtps chooses the transports itself, shared memory among them. The last one keeps
Fast DDS from the profile in the folder where the node is started.
"""
_CYCLONE = {_RANGE: "LOCALHOST"}
"""Cyclone DDS takes `lo` for an interface without multicast, and then needs to be told of it."""
_RMW = "RMW_IMPLEMENTATION"
_DDS = ("rmw_fastrtps", "rmw_cyclonedds")


def cell_environ(address: str, outside: Mapping[str, str]) -> dict[str, str]:
    """Return the environment in a cell, for the domain of an address.

    InputError if the RMW is none that needs nothing but `lo`, or SROS2 is on.
    """
    rmw = outside.get(_RMW, "")
    if rmw and not rmw.startswith(_DDS):
        help = "use rmw_fastrtps_cpp or rmw_cyclonedds_cpp; for Zenoh see its access control"
        raise InputError(f"{rmw} does not work in a cell", help=help)
    if outside.get("ROS_SECURITY_ENABLE", "").lower() == "true":
        help = "a cell is for ROS 2 without it: unset ROS_SECURITY_ENABLE, or start no cell"
        raise InputError("SROS2 and a cell do not work together", help=help)
    inherited = {name: text for name, text in outside.items() if not name.startswith(_LEFT)}
    chosen = {_RMW: rmw} if rmw else {}
    tuning = _CYCLONE if rmw.startswith("rmw_cyclonedds") else _FAST_DDS
    return {**inherited, **chosen, **tuning, "ROS_DOMAIN_ID": str(domain_at(address))}


def copy_parameter_files(command: Sequence[str], folder: str) -> list[str]:
    """Return a command that reads its parameter files from copies in a folder of the node's user.

    What launch writes for a node, only the user of launch may read.
    """
    words = list(command)
    for at, (flag, path) in enumerate(pairwise(command), start=1):
        if flag == "--params-file" and Path(path).is_file():
            words[at] = shutil.copyfile(path, f"{folder}/{at}_{Path(path).name}")
    return words
