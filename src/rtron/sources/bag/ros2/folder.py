"""A ROS 2 bag folder: `metadata.yaml` and the files it lists (rosbag2, versions 1 to 9)."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from pathlib import Path, PurePosixPath

from rtron.errors import InputError
from rtron.sources.bag.common.compression import unpack_zstd
from rtron.sources.bag.common.limits import MAX_CHUNK, DamageError, damaged
from rtron.sources.bag.common.reader import BagConnection, BagReading, Message
from rtron.sources.bag.file_type import METADATA, ROOT
from rtron.sources.bag.mcap.reader import read_mcap
from rtron.sources.bag.ros2.sqlite import read_sqlite
from rtron.sources.bounded_file import read_bounded
from rtron.sources.launch.common.yaml_tree import YamlTree, parse_yaml, plain
from rtron.vocabulary import ParameterValue

_MAX_METADATA = 4 * 2**20
_MAX_FILES = 10_000
_REINDEX = "`ros2 bag reindex FOLDER` writes it anew"
_STORAGES: Mapping[str, Callable[[Path], BagReading]] = {
    "sqlite3": read_sqlite,
    "mcap": read_mcap,
}


def read_bag_folder(path: Path) -> BagReading:
    """Return the connections of a bag's files together, and the way to their messages.

    The files are read in the order they are listed, and only from the folder itself. Raise
    InputError where one is missing, damaged, or packed as a whole.
    """
    metadata = _metadata(path / METADATA)
    files = tuple(_files(metadata, path))
    read = _STORAGES.get(str(metadata.get("storage_identifier")))
    if read is None:
        help = "RTron reads `sqlite3` and `mcap`"
        raise InputError("its storage_identifier is unknown", path=str(path), help=help)
    return _joined(path, [read(file) for file in files], packed=_is_packed(metadata, path))


def _metadata(path: Path) -> dict[str, ParameterValue]:
    text = read_bounded(path, _MAX_METADATA).decode(errors="replace")
    try:
        documents = parse_yaml(text, str(path)).documents
        root = _mapping(documents[0]) if documents and documents[0] is not None else {}
    except InputError as error:
        error.help = error.help or _REINDEX
        raise
    found = root.get(ROOT)
    if not isinstance(found, dict):
        raise InputError(f"has no {ROOT}", path=str(path), help=_REINDEX)
    return found


def _mapping(tree: YamlTree) -> dict[str, ParameterValue]:
    return {key: plain(inner) for key, inner in tree.items()} if isinstance(tree, dict) else {}


def _files(metadata: Mapping[str, ParameterValue], folder: Path) -> Iterator[Path]:
    """Yield the bag's files: older versions list them with the folder's name before theirs."""
    listed = metadata.get("relative_file_paths")
    if not isinstance(listed, list) or not 0 < len(listed) <= _MAX_FILES:
        why = "does not list the files of the bag"
        raise InputError(why, path=str(folder / METADATA), help=_REINDEX)
    for each in listed:
        path = folder / PurePosixPath(str(each)).name
        if not path.is_file():
            why = f"lists {str(each)[:200]!r}, which is not in the folder"
            raise InputError(why, path=str(folder / METADATA), help=_REINDEX)
        yield path


def _is_packed(metadata: Mapping[str, ParameterValue], path: Path) -> bool:
    """Tell whether each message is packed; raise InputError if the files are, or not by zstd."""
    mode = str(metadata.get("compression_mode") or "none").lower()
    if mode == "file":
        help = "unpack it (`zstd -d FILE`) and give the .db3 or .mcap file"
        raise InputError("its files are packed as a whole", path=str(path), help=help)
    if mode == "message" and metadata.get("compression_format") != "zstd":
        raise InputError("its messages are packed, but not by zstd", path=str(path), help=_REINDEX)
    return mode == "message"


def _joined(path: Path, readings: Sequence[BagReading], *, packed: bool) -> BagReading:
    """Return the readings as one; a topic that goes on in the next file stays one connection."""
    shared: dict[object, BagConnection] = {}
    for connection in (each for reading in readings for each in reading.connections):
        shared.setdefault(_key(connection), connection)
    messages = partial(_messages, tuple(readings), shared)
    return BagReading(
        path=path,
        connections=tuple(shared.values()),
        messages=partial(_unpacked, messages, path) if packed else messages,
        left_out=tuple(dict.fromkeys(pair for reading in readings for pair in reading.left_out)),
    )


def _key(connection: BagConnection) -> object:
    return connection.topic, connection.type, connection.encoding, connection.callerid


def _messages(
    readings: Sequence[BagReading], shared: Mapping[object, BagConnection]
) -> Iterator[Message]:
    last = -(2**63)
    for reading in readings:
        same = {each: shared[_key(each)] for each in reading.connections}
        for time, connection, data in reading:
            if time < last:
                help = "read its files one by one"
                raise InputError("overlaps with the file before", path=str(reading.path), help=help)
            last = time
            yield time, same[connection], data


def _unpacked(messages: Callable[[], Iterator[Message]], path: Path) -> Iterator[Message]:
    try:
        for time, connection, data in messages():
            yield time, connection, unpack_zstd(data, MAX_CHUNK)
    except DamageError as error:
        raise damaged(path, str(error), "record it again") from None
