"""The messages of a bag of either ROS, for a replay: raw, in the order of time, in little memory.

RTron reads the formats itself: a reader must never unpack more than a chunk at a time, hold an
entry for every message, or make Python code of message definitions, whatever the file says.
"""

from collections.abc import Callable, Mapping
from pathlib import Path

from rtron.errors import InputError
from rtron.folders import is_folder
from rtron.sources.bag.common.reader import BagReader
from rtron.sources.bag.mcap.reader import open_mcap
from rtron.sources.bag.ros1.reader import open_ros1_bag
from rtron.sources.bag.ros2.folder import open_bag_folder
from rtron.sources.bag.ros2.sqlite import open_sqlite

_READERS: Mapping[str, Callable[[Path], BagReader]] = {
    ".bag": open_ros1_bag,
    ".mcap": open_mcap,
    ".db3": open_sqlite,
}


def open_bag(path: Path) -> BagReader:
    """Open a bag: a ROS 1 .bag, a .mcap, a .db3, or the folder of a ROS 2 bag.

    Nothing but its index is read; iterate over the reading for (time in ns, connection, serialised
    message) in the order of time. Raise InputError, then or while iterating, where it is damaged.
    Memory is bounded by constants (`limits`), time by the size of the file.
    """
    if is_folder(path):
        return open_bag_folder(path)
    if path.suffix not in _READERS:
        help = "give a .bag, .mcap or .db3 file, or the folder of a ROS 2 bag"
        raise InputError("no bag that RTron knows", path=str(path), help=help)
    return _READERS[path.suffix](path)
