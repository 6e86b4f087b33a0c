"""A ROS 2 bag folder: `metadata.yaml` and the files it lists (rosbag2, versions 1 to 9)."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from pathlib import Path, PurePosixPath

from rtron.errors import InputError
from rtron.sources.bag.common.compression import decompress_zstd
from rtron.sources.bag.common.reader import (
    MAX_CHUNK_BYTES,
    BagConnection,
    BagReader,
    DamageError,
    Message,
    damage_error,
)
from rtron.sources.bag.file_type import METADATA, METADATA_KEY
from rtron.sources.bag.mcap.reader import open_mcap
from rtron.sources.bag.ros2.sqlite import open_sqlite
from rtron.sources.bounded_file import read_bounded
from rtron.sources.launch.common.yaml_tree import YamlTree, parse_yaml, plain_value
from rtron.vocabulary import ParameterValue

_MAX_METADATA_BYTES = 4 * 2**20
_MAX_FILES = 10_000
_REINDEX_HELP = "`ros2 bag reindex FOLDER` writes it anew"
_STORAGE_READERS: Mapping[str, Callable[[Path], BagReader]] = {
    "sqlite3": open_sqlite,
    "mcap": open_mcap,
}


def open_bag_folder(path: Path) -> BagReader:
    """Return the connections of a bag's files together, and the way to their messages.

    The files are read in the order they are listed, and only from the folder itself. Raise
    InputError where one is missing, damaged, or packed as a whole.
    """
    metadata = _metadata(path / METADATA)
    files = tuple(_listed_files(metadata, path))
    open_file = _STORAGE_READERS.get(str(metadata.get("storage_identifier")))
    if open_file is None:
        help = "RTron reads `sqlite3` and `mcap`"
        raise InputError("its storage_identifier is unknown", path=str(path), help=help)
    return _merged(
        path, [open_file(file) for file in files], compressed=_is_message_compressed(metadata, path)
    )


def _metadata(path: Path) -> dict[str, ParameterValue]:
    text = read_bounded(path, _MAX_METADATA_BYTES).decode(errors="replace")
    try:
        documents = parse_yaml(text, str(path)).documents
        root = _mapping(documents[0]) if documents and documents[0] is not None else {}
    except InputError as error:
        error.help = error.help or _REINDEX_HELP
        raise
    metadata = root.get(METADATA_KEY)
    if not isinstance(metadata, dict):
        raise InputError(f"has no {METADATA_KEY}", path=str(path), help=_REINDEX_HELP)
    return metadata


def _mapping(tree: YamlTree) -> dict[str, ParameterValue]:
    return (
        {key: plain_value(inner) for key, inner in tree.items()} if isinstance(tree, dict) else {}
    )


def _listed_files(metadata: Mapping[str, ParameterValue], folder: Path) -> Iterator[Path]:
    """Yield the bag's files: older versions list them with the folder's name before theirs."""
    names = metadata.get("relative_file_paths")
    if not isinstance(names, list) or not 0 < len(names) <= _MAX_FILES:
        why = "does not list the files of the bag"
        raise InputError(why, path=str(folder / METADATA), help=_REINDEX_HELP)
    for each in names:
        path = folder / PurePosixPath(str(each)).name
        if not path.is_file():
            why = f"lists {str(each)[:200]!r}, which is not in the folder"
            raise InputError(why, path=str(folder / METADATA), help=_REINDEX_HELP)
        yield path


def _is_message_compressed(metadata: Mapping[str, ParameterValue], path: Path) -> bool:
    """Tell whether each message is packed; raise InputError if the files are, or not by zstd."""
    mode = str(metadata.get("compression_mode") or "none").lower()
    if mode == "file":
        help = "unpack it (`zstd -d FILE`) and give the .db3 or .mcap file"
        raise InputError("its files are packed as a whole", path=str(path), help=help)
    if mode == "message" and metadata.get("compression_format") != "zstd":
        raise InputError(
            "its messages are packed, but not by zstd", path=str(path), help=_REINDEX_HELP
        )
    return mode == "message"


def _merged(path: Path, readers: Sequence[BagReader], *, compressed: bool) -> BagReader:
    """Return the readings as one; a topic that goes on in the next file stays one connection."""
    shared: dict[object, BagConnection] = {}
    for connection in (each for reading in readers for each in reading.connections):
        shared.setdefault(_connection_key(connection), connection)
    messages = partial(_messages, tuple(readers), shared)
    return BagReader(
        path=path,
        connections=tuple(shared.values()),
        messages=partial(_decompressed, messages, path) if compressed else messages,
        skipped=tuple(dict.fromkeys(pair for reading in readers for pair in reading.skipped)),
    )


def _connection_key(connection: BagConnection) -> object:
    return connection.topic, connection.type, connection.encoding, connection.callerid


def _messages(
    readers: Sequence[BagReader], shared: Mapping[object, BagConnection]
) -> Iterator[Message]:
    last_time = -(2**63)
    for reader in readers:
        merged = {each: shared[_connection_key(each)] for each in reader.connections}
        for time, connection, data in reader:
            if time < last_time:
                help = "read its files one by one"
                raise InputError("overlaps with the file before", path=str(reader.path), help=help)
            last_time = time
            yield time, merged[connection], data


def _decompressed(messages: Callable[[], Iterator[Message]], path: Path) -> Iterator[Message]:
    try:
        for time, connection, data in messages():
            yield time, connection, decompress_zstd(data, MAX_CHUNK_BYTES)
    except DamageError as error:
        raise damage_error(path, str(error), "record it again") from None
