"""Bags written for the tests: by rosbags' writers, and record by record."""

import struct

from rosbags.interfaces import (
    Qos,
    QosDurability,
    QosHistory,
    QosLiveliness,
    QosReliability,
    QosTime,
)
from rosbags.rosbag1 import Writer as Writer1
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin
from rosbags.rosbag2 import Writer as Writer2

SECOND = 10**9
TWIST = "Vector3 linear\nVector3 angular\n"
TWIST_MD5 = "9f195f881246fdfa2798d1d3eebca84a"
PACKED = {"bz2": Writer1.CompressionFormat.BZ2, "lz4": Writer1.CompressionFormat.LZ4}
NO_TIME = QosTime(0, 0)


def twist(x):
    return struct.pack("<6d", x, 0, 0, 0, 0, 0)


def add_ros1_connection(writer, topic="/cmd_vel", type="geometry_msgs/msg/Twist", **more):
    return writer.add_connection(topic, type, msgdef=TWIST, md5sum=TWIST_MD5, **more)


def ros1_bag(path, times=range(1, 101), *, packed=None, chunk=2**20, callers=("/a", "/b")):
    """Write a bag whose messages come from the callers in turn, with the given times (s)."""
    writer = Writer1(path)
    writer.chunk_threshold = chunk
    if packed:
        writer.set_compression(PACKED[packed])
    with writer:
        streams = [add_ros1_connection(writer, callerid=caller, latching=0) for caller in callers]
        for number, time in enumerate(times):
            writer.write(streams[number % len(streams)], int(time * SECOND), twist(number))
    return path


def qos(reliability=QosReliability.RELIABLE, durability=QosDurability.VOLATILE, depth=10):
    return Qos(
        QosHistory.KEEP_LAST,
        depth,
        reliability,
        durability,
        NO_TIME,
        NO_TIME,
        QosLiveliness.AUTOMATIC,
        NO_TIME,
        False,  # noqa: FBT003
    )


def ros2_bag(folder, storage="mcap", times=range(1, 101), *, mode=None, version=9, **more):
    """Write a ROS 2 bag with two topics in turn."""
    writer = Writer2(folder, version=version, storage_plugin=StoragePlugin[storage.upper()])
    if mode:
        writer.set_compression(CompressionMode[mode.upper()], CompressionFormat.ZSTD)
    with writer:
        streams = [
            add_ros2_connection(writer, topic, **more) for topic in ("/cmd_vel", "/other/cmd_vel")
        ]
        for number, time in enumerate(times):
            writer.write(streams[number % 2], int(time * SECOND), b"\0\1\0\0" + twist(number))
    return folder


def add_ros2_connection(writer, topic, **more):
    type = "geometry_msgs/msg/Twist"
    more = {"msgdef": TWIST, "rihs01": "RIHS01_0"} | more
    return writer.add_connection(topic, type, **more)


def ros1_record(header, data=b""):
    """Return a record of a ROS 1 bag."""
    fields = b"".join(
        struct.pack("<I", len(name) + 1 + len(value)) + name + b"=" + value
        for name, value in header.items()
    )
    return struct.pack("<I", len(fields)) + fields + struct.pack("<I", len(data)) + data


def ros1_message_record(conn, seconds, data, order=(b"conn", b"op", b"time")):
    values = {
        b"op": b"\x02",
        b"conn": struct.pack("<I", conn),
        b"time": struct.pack("<II", seconds, 0),
    }
    return ros1_record({name: values[name] for name in order}, data)


def ros1_connection_record(conn, topic, **fields):
    outer = {b"op": b"\x07", b"conn": struct.pack("<I", conn), b"topic": topic.encode()}
    inner = {"type": "geometry_msgs/Twist", "md5sum": TWIST_MD5, "message_definition": ""} | fields
    data = b"".join(
        struct.pack("<I", len(name) + 1 + len(value)) + name.encode() + b"=" + value
        for name, value in (
            (n, v if isinstance(v, bytes) else v.encode()) for n, v in inner.items()
        )
    )
    return ros1_record(outer, data)


def write_ros1_records(path, chunks, *, connections=None, counts=None, infos=None):
    """Write a ROS 1 bag of chunks: each (first second, compression, unpacked size, data)."""
    connections = connections or [ros1_connection_record(0, "/cmd_vel", callerid="/a")]
    body, places = b"", []
    for start, compression, size, data in chunks:
        places.append((start, 13 + 4096 + len(body)))
        header = {b"op": b"\x05", b"compression": compression, b"size": struct.pack("<I", size)}
        body += ros1_record(header, data)
    index = b"".join(connections) + b"".join(
        ros1_chunk_info_record(*place) for place in infos or places
    )
    counts = counts or (len(connections), len(infos or places))
    header = {
        b"op": b"\x03",
        b"index_pos": struct.pack("<Q", 13 + 4096 + len(body)),
        b"conn_count": struct.pack("<I", counts[0]),
        b"chunk_count": struct.pack("<I", counts[1]),
    }
    padding = b" " * (4096 - len(ros1_record(header)))
    path.write_bytes(b"#ROSBAG V2.0\n" + ros1_record(header, padding) + body + index)
    return path


def ros1_chunk_info_record(start, place):
    time = struct.pack("<II", start, 0)
    header = {
        b"op": b"\x06",
        b"ver": struct.pack("<I", 1),
        b"chunk_pos": struct.pack("<Q", place),
        b"start_time": time,
        b"end_time": time,
        b"count": struct.pack("<I", 1),
    }
    return ros1_record(header, struct.pack("<II", 0, 1))


MCAP = b"\x89MCAP0\r\n"


def text(value):
    data = value.encode()
    return struct.pack("<I", len(data)) + data


def mcap_record(kind, data):
    """Return a record of an MCAP file."""
    return struct.pack("<BQ", kind, len(data)) + data


def schema(id=1, name="geometry_msgs/Twist", encoding="ros1msg", definition=TWIST):
    return mcap_record(3, struct.pack("<H", id) + text(name) + text(encoding) + text(definition))


def channel(id=1, topic="/cmd_vel", encoding="ros1", metadata=None, schema=1):
    pairs = b"".join(text(key) + text(value) for key, value in (metadata or {}).items())
    ids = struct.pack("<HH", id, schema)
    packed = struct.pack("<I", len(pairs)) + pairs
    return mcap_record(4, ids + text(topic) + text(encoding) + packed)


def mcap_message_record(channel, time, data):
    return mcap_record(5, struct.pack("<HIQQ", channel, 0, time, time) + data)


def mcap_chunk_record(start, data, *, compression="", size=None):
    """Return a chunk's record and the size it declares."""
    size = len(data) if size is None else size
    head = struct.pack("<QQQI", start, start, size, 0) + text(compression)
    return mcap_record(6, head + struct.pack("<Q", len(data)) + data), size


def chunk_index(start, at, length, size):
    data = struct.pack("<QQQQ", start, start, at, length) + struct.pack("<IQ", 0, 0) + text("")
    return mcap_record(8, data + struct.pack("<QQ", length, size))


def write_mcap_records(path, summary, *, body=b"", chunks=(), start=None):
    """Write an MCAP: a body as it is, then chunks of (first time, (record, unpacked size))."""
    data = MCAP + mcap_record(1, text("ros1") + text("tests")) + body
    for first, (record, size) in chunks:
        summary += chunk_index(first, len(data), len(record), size)
        data += record
    data += mcap_record(15, struct.pack("<I", 0))
    at = len(data) if start is None else start
    footer = mcap_record(2, struct.pack("<QQI", at, 0, 0))
    path.write_bytes(data + summary + footer + MCAP)
    return path
