"""Messages of bags: the same that rosbags reads, in the order of time."""

import shutil
import sqlite3
import tracemalloc
from collections import Counter
from itertools import pairwise

import pytest
from bag_files import (
    SECOND,
    TWIST,
    TWIST_MD5,
    add_ros1_connection,
    channel,
    mcap_chunk_record,
    mcap_message_record,
    qos,
    ros1_bag,
    ros1_connection_record,
    ros1_message_record,
    ros2_bag,
    schema,
    twist,
    write_mcap_records,
    write_ros1_records,
)
from hypothesis import given
from hypothesis import strategies as st
from rosbags.interfaces import QosDurability, QosReliability
from rosbags.rosbag1 import Reader as Reader1
from rosbags.rosbag1 import Writer as Writer1
from rosbags.rosbag2 import Reader as Reader2

from rtron.errors import InputError
from rtron.sources.bag.file_type import is_bag
from rtron.sources.bag.formats import open_bag
from rtron.vocabulary import Durability, QoS, Reliability


def indexed(path):
    with Reader1(path) as reader:
        return [entry for index in reader.indexes.values() for entry in index]


def read(path):
    return [(time, each.topic, each.callerid, data) for time, each, data in open_bag(path)]


def peer1(path):
    with Reader1(path) as reader:
        return [
            (time, each.topic, each.ext.callerid, data) for each, time, data in reader.messages()
        ]


def peer2(path):
    with Reader2(path) as reader:
        return [(time, each.topic, "", data) for each, time, data in reader.messages()]


@pytest.mark.parametrize("packed", [None, "bz2", "lz4"])
@pytest.mark.parametrize("chunk", [1, 500, 2**20])
def test_a_ros1_bag_is_read_as_rosbags_reads_it(tmp_path, packed, chunk):
    path = ros1_bag(tmp_path / "run.bag", packed=packed, chunk=chunk)
    found = read(path)
    assert found == peer1(path)
    assert len(found) == 100
    assert found[1] == (2 * SECOND, "/cmd_vel", "/b", twist(1))


@pytest.mark.parametrize("storage", ["mcap", "sqlite3"])
@pytest.mark.parametrize(("mode", "version"), [(None, 8), (None, 9), ("message", 9)])
def test_a_ros2_bag_is_read_as_rosbags_reads_it(tmp_path, storage, mode, version):
    path = ros2_bag(tmp_path / "run", storage, mode=mode, version=version)
    found = read(path)
    assert found == peer2(path)
    assert len(found) == 100


@pytest.mark.parametrize(("storage", "suffix"), [("mcap", "mcap"), ("sqlite3", "db3")])
def test_a_single_file_of_a_ros2_bag(tmp_path, storage, suffix):
    folder = ros2_bag(tmp_path / "run", storage)
    path = shutil.copy(folder / f"run.{suffix}", tmp_path / f"50% of a #run?.{suffix}")
    assert read(path) == read(folder)


def test_a_packed_mcap(tmp_path):
    path = ros2_bag(tmp_path / "run", "mcap", mode="storage", times=range(1, 30_000))
    (file,) = path.glob("*.mcap")
    assert b"zstd" in file.read_bytes()
    assert read(file) == peer2(file)


@given(
    times=st.lists(st.integers(0, 40), min_size=1, max_size=60),
    chunk=st.sampled_from([1, 150, 500, 2**20]),
)
def test_whatever_the_order_it_was_written_in_time_never_goes_back(tmp_path_factory, times, chunk):
    path = tmp_path_factory.mktemp("bags") / "run.bag"
    found = read(ros1_bag(path, times, chunk=chunk))
    assert sorted(found) == sorted(peer1(path))
    assert all(one[0] <= next[0] for one, next in pairwise(found))


def test_messages_of_one_time_come_as_they_stand_in_the_file(tmp_path):
    path = ros1_bag(tmp_path / "run.bag", [5] * 20, chunk=150)
    assert [data for *_, data in read(path)] == [twist(number) for number in range(20)]


@pytest.mark.parametrize(
    "order",
    [
        (b"conn", b"op", b"time"),
        (b"op", b"conn", b"time"),
        (b"conn", b"time", b"op"),
        (b"time", b"op", b"conn"),
    ],
)
def test_a_header_has_its_fields_in_any_order(tmp_path, order):
    chunk = ros1_connection_record(0, "/cmd_vel") + b"".join(
        ros1_message_record(0, second, b"%d" % second, order) for second in (1, 2)
    )
    other = ros1_message_record(0, 3, b"3", order[::-1])
    path = write_ros1_records(tmp_path / "x.bag", [(1, b"none", len(chunk + other), chunk + other)])
    assert [(t // SECOND, d) for t, _, _, d in read(path)] == [(1, b"1"), (2, b"2"), (3, b"3")]


def test_a_connection_of_ros1_says_what_was_recorded(tmp_path):
    path = tmp_path / "run.bag"
    with Writer1(path) as writer:
        writer.write(add_ros1_connection(writer, callerid="/map_server", latching=1), 1, twist(0))
        writer.write(add_ros1_connection(writer, topic="/nobody"), 2, twist(0))
    latched, nobody = open_bag(path).connections
    assert (latched.callerid, latched.latching, latched.encoding) == ("/map_server", True, "ros1")
    assert (latched.type, latched.md5sum) == ("geometry_msgs/Twist", TWIST_MD5)
    assert (latched.definition, latched.definition_format) == (TWIST, "ros1msg")
    assert (nobody.topic, nobody.callerid, nobody.latching) == ("/nobody", "", False)


def test_a_definition_may_have_comments_in_any_encoding(tmp_path):
    connections = [ros1_connection_record(0, "/x", message_definition=b"# 90\xb0\nint8 x")]
    path = write_ros1_records(tmp_path / "x.bag", [], connections=connections)
    assert open_bag(path).connections[0].definition == "# 90�\nint8 x"


@pytest.mark.parametrize("storage", ["mcap", "sqlite3"])
@pytest.mark.parametrize("version", [8, 9])
def test_a_connection_of_ros2_has_the_qos_offered(tmp_path, storage, version):
    latched = qos(QosReliability.BEST_EFFORT, QosDurability.TRANSIENT_LOCAL, 1)
    path = ros2_bag(
        tmp_path / "run", storage, version=version, offered_qos_profiles=[qos(depth=7), latched]
    )
    each = open_bag(path).connections[0]
    assert (each.topic, each.type, each.encoding) == ("/cmd_vel", "geometry_msgs/msg/Twist", "cdr")
    assert (each.definition, each.definition_format, each.callerid) == (TWIST, "ros2msg", "")
    assert each.offered_qos == (
        QoS(depth=7),
        QoS(reliability=Reliability.BEST_EFFORT, durability=Durability.TRANSIENT_LOCAL, depth=1),
    )


def test_an_mcap_made_of_a_ros1_bag_names_publishers(tmp_path):
    metadata = {"callerid": "/a", "latching": "1", "md5sum": TWIST_MD5}
    data = mcap_message_record(1, 7, b"seven") + mcap_message_record(1, 5, b"five")
    path = write_mcap_records(
        tmp_path / "x.mcap",
        schema() + channel(metadata=metadata),
        chunks=[(5, mcap_chunk_record(5, data))],
    )
    reading = open_bag(path)
    (each,) = reading.connections
    assert (each.callerid, each.latching, each.md5sum) == ("/a", True, TWIST_MD5)
    assert (each.encoding, each.definition_format) == ("ros1", "ros1msg")
    assert list(reading) == [(5, each, b"five"), (7, each, b"seven")]


def test_messages_outside_of_chunks(tmp_path):
    body = mcap_message_record(1, 5, b"five") + mcap_message_record(1, 7, b"seven")
    path = write_mcap_records(tmp_path / "x.mcap", schema() + channel(), body=body)
    assert [data for *_, data in read(path)] == [b"five", b"seven"]


def test_messages_that_are_not_of_ros_are_left_out_and_named(tmp_path):
    data = mcap_message_record(1, 1, b"kept") + mcap_message_record(2, 2, b"{}")
    summary = schema() + channel() + channel(id=2, topic="/json", encoding="json")
    path = write_mcap_records(
        tmp_path / "x.mcap", summary, chunks=[(1, mcap_chunk_record(1, data))]
    )
    reading = open_bag(path)
    assert [data for *_, data in reading] == [b"kept"]
    ((topic, why),) = reading.skipped
    assert topic == "/json"
    assert "'json'" in why


def test_a_bag_that_was_split(tmp_path):
    folder = ros2_bag(tmp_path / "run", "sqlite3", range(1, 11))
    later = ros2_bag(tmp_path / "later", "sqlite3", range(11, 21))
    shutil.copy(later / "later.db3", folder / "run_1.db3")
    metadata = folder / "metadata.yaml"
    listed = metadata.read_text().replace("- run.db3", "- run.db3\n  - run_1.db3", 1)
    metadata.write_text(listed)
    reading = open_bag(folder)
    assert [time // SECOND for time, *_ in reading] == list(range(1, 21))
    assert {each for _, each, _ in reading} == set(reading.connections)
    assert len(reading.connections) == 2
    metadata.write_text(listed.replace("- run.db3\n  - run_1.db3", "- run_1.db3\n  - run.db3"))
    with pytest.raises(InputError, match="overlaps with the file before"):
        list(open_bag(folder))


def test_a_reading_can_be_read_again(tmp_path):
    reading = open_bag(ros1_bag(tmp_path / "run.bag"))
    assert list(reading) == list(reading)


def test_an_empty_bag(tmp_path):
    with Writer1(tmp_path / "x.bag"):
        pass
    assert list(open_bag(tmp_path / "x.bag")) == []


def test_what_waits_for_later_chunks_is_bounded(tmp_path, monkeypatch):
    times = [1, 60, *range(2, 50)]
    path = ros1_bag(tmp_path / "run.bag", times, chunk=500)
    in_chunk = max(Counter(each.chunk_pos for each in indexed(path)).values())
    most = (in_chunk + 1) * (len(twist(0)) + 200)
    monkeypatch.setattr("rtron.sources.bag.common.reader.MAX_PENDING_BYTES", most)
    assert len(read(path)) == 50
    monkeypatch.setattr("rtron.sources.bag.common.reader.MAX_PENDING_BYTES", most - 1)
    with pytest.raises(InputError, match="overlap by more than"):
        read(path)


def test_an_old_schema_of_sqlite(tmp_path):
    path = tmp_path / "old.db3"
    with sqlite3.connect(path) as database:
        database.executescript(
            "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT, type TEXT,"
            " serialization_format TEXT);"
            "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER, timestamp INTEGER,"
            " data BLOB);"
            "INSERT INTO topics VALUES(4, '/t', 'x/msg/Y', 'cdr'), (5, '/u', 'x/msg/Z', 'json');"
            "INSERT INTO messages VALUES(1, 4, 9, x'01'), (2, 4, 8, x'02'), (3, 5, 1, x'03');"
        )
    database.close()
    assert read(path) == [(8, "/t", "", b"\2"), (9, "/t", "", b"\1")]
    assert open_bag(path).skipped[0][0] == "/u"


@pytest.mark.parametrize(("kind", "number"), [("bag", 6_000), ("mcap", 20_000), ("db3", 6_000)])
def test_memory_does_not_grow_with_the_bag(tmp_path, kind, number):
    """Of MCAP, 20,000 messages fill a chunk."""

    def most(count):
        path = tmp_path / f"{count}.bag"
        if kind == "bag":
            ros1_bag(path, range(count), chunk=2**16)
        else:
            folder = ros2_bag(path, {"mcap": "mcap", "db3": "sqlite3"}[kind], range(count))
            (path,) = folder.glob(f"*.{kind}")
        tracemalloc.start()
        assert sum(1 for _ in open_bag(path)) == count
        _, peak = tracemalloc.get_traced_memory()
        tracemalloc.stop()
        return peak

    assert most(4 * number) < 2 * most(number) < 20 * 2**20


def test_a_path_is_known_to_be_a_bag(tmp_path):
    assert is_bag(ros2_bag(tmp_path / "run"))
    assert not is_bag(tmp_path)
    (tmp_path / "metadata.yaml").write_text("title: x")
    assert not is_bag(tmp_path)
    assert is_bag(tmp_path / "none.mcap")
    assert not is_bag(tmp_path / "graph.json")
