"""Bags that are damaged or made to harm: always an InputError that names the file, and soon."""

import bz2
import os
import random
import sqlite3
import struct
import tracemalloc
from contextlib import closing

import lz4.frame
import pytest
from bag_files import (
    MCAP,
    channel,
    mcap_chunk_record,
    mcap_message_record,
    mcap_record,
    ros1_bag,
    ros1_connection_record,
    ros1_message_record,
    ros1_record,
    ros2_bag,
    schema,
    write_mcap_records,
    write_ros1_records,
)
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from example_budget import examples
from rtron.errors import InputError
from rtron.sources.bag.common.compression import decompress, decompress_zstd
from rtron.sources.bag.formats import open_bag
from rtron.sources.bag.mcap import record as mcap_record_module
from rtron.sources.bag.ros1 import reader
from rtron.sources.bag.ros1 import record as ros1_record_module
from rtron.sources.bag.ros2 import sqlite
from rtron.sources.bag.ros2.offered_qos import parse_offered_qos
from rtron.vocabulary import QoS

MEBIBYTE = 2**20


def fault(path):
    with pytest.raises(InputError) as raised:
        list(open_bag(path))
    assert str(raised.value).startswith(str(path))
    assert raised.value.help
    return str(raised.value)


def chunk1(data=b"", start=1, compression=b"none", size=None):
    return start, compression, len(data) if size is None else size, data


@pytest.mark.parametrize("suffix", ["bag", "mcap", "db3"])
@pytest.mark.parametrize("content", [b"", b"\0" * 100, b"#ROSBAG V2.0", MCAP, MCAP * 5])
def test_what_is_no_bag(tmp_path, suffix, content):
    path = tmp_path / f"x.{suffix}"
    path.write_bytes(content)
    assert str(path) in fault(path)


def test_paths_that_are_no_bags(tmp_path):
    assert "No such file" in fault(tmp_path / "none.bag")
    assert "metadata.yaml" in fault_of_folder(tmp_path)
    (tmp_path / "x.bag").mkdir()
    assert "metadata.yaml" in fault_of_folder(tmp_path / "x.bag")
    assert "no bag that RTron knows" in fault(tmp_path / "x.rosbag")
    os.mkfifo(tmp_path / "pipe.bag")
    assert "is no file" in fault(tmp_path / "pipe.bag")


def fault_of_folder(path):
    with pytest.raises(InputError) as raised:
        open_bag(path)
    return str(raised.value)


def test_an_old_bag_and_one_that_was_not_closed(tmp_path):
    path = tmp_path / "x.bag"
    path.write_bytes(b"#ROSBAG V1.2\n")
    assert "another version" in fault(path)
    header = {b"op": b"\x03", b"index_pos": bytes(8), b"conn_count": bytes(4)}
    path.write_bytes(b"#ROSBAG V2.0\n" + ros1_record(header))
    assert "was not closed" in fault(path)
    path.write_bytes(b"#ROSBAG V2.0\n" + ros1_record({b"op": b"\x03", b"encryptor": b"x"}))
    assert "encrypted" in fault(path)


@pytest.mark.parametrize(
    ("damage", "said"),
    [
        ({"counts": (2, 1)}, "number of entries"),
        ({"counts": (1, 2**32 - 1)}, "number of entries"),
        ({"infos": [(1, 2**63)]}, "cut off"),
        ({"infos": [(1, 0)]}, "a record of"),
        ({"infos": [(1, 13)]}, "points to no chunk"),
        ({"infos": [(1, 13 + 4096)] * 1000}, "number of entries"),
        ({"infos": [(2, 13 + 4096)]}, "wrong time for a chunk"),
        ({"connections": [ros1_connection_record(7, "/x")]}, "a message of no connection (0)"),
        ({"connections": [ros1_record({b"op": b"\x07"})]}, "no field 'topic'"),
        ({"connections": [ros1_connection_record(0, "/x", callerid=b"\xff")]}, "can't decode"),
        ({"connections": [ros1_connection_record(0, "/x", type=b"\xff")]}, "can't decode"),
        ({"connections": [ros1_record({b"op": b"\x09"})]}, "another kind"),
        ({"connections": [b"\xff\xff\xff\xff"]}, "a record of 4294967295 bytes"),
    ],
)
def test_an_index_that_lies(tmp_path, damage, said):
    data = ros1_message_record(0, 1, b"x")
    assert said in fault(write_ros1_records(tmp_path / "x.bag", [chunk1(data)], **damage))


@pytest.mark.parametrize(
    ("chunk", "said"),
    [
        (chunk1(b"x" * 10, compression=b"gz"), "unknown compression 'gz'"),
        (chunk1(b"x" * 10, size=11), "does not unpack to the 11 bytes"),
        (chunk1(b"x" * 10, compression=b"bz2"), "no bz2"),
        (chunk1(b"x" * 10, compression=b"lz4"), "no lz4"),
        (chunk1(b"x" * 10, size=reader.MAX_CHUNK_BYTES + 1), "more than 268435456"),
        (chunk1(ros1_message_record(0, 1, b"xyz")[:-1]), "longer than its chunk"),
        (chunk1(ros1_message_record(0, 1, b"xyz") + b"\0" * 3), "wrong size"),
        (chunk1(b"\xff" * 50), "longer than its chunk"),
        (chunk1(ros1_record({b"op": b"\x06"})), "no message and no connection"),
        (chunk1(ros1_record({b"op": b"\x02", b"conn": bytes(4), b"time": b"x"})), "wrong size"),
        (chunk1(ros1_message_record(9, 1, b"")), "no connection (9)"),
    ],
)
def test_a_chunk_that_lies(tmp_path, chunk, said):
    assert said in fault(write_ros1_records(tmp_path / "x.bag", [chunk]))


def packed_by(compression, data):
    if compression == "bz2":
        return bz2.compress(data)
    if compression == "lz4":
        return lz4.frame.compress(data)
    return zstd().compress(data)


def zstd():
    return pytest.importorskip("backports.zstd", reason="needs backports.zstd")


@pytest.mark.parametrize("compression", ["bz2", "lz4", "zstd"])
def test_a_bomb_unpacks_no_further_than_it_says(compression):
    bomb = packed_by(compression, bytes(64 * MEBIBYTE))
    tracemalloc.start()
    for size in (0, MEBIBYTE):
        with pytest.raises(reader.DamageError, match="does not unpack"):
            decompress(compression, bomb, size)
    _, most = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert most < 4 * MEBIBYTE
    assert decompress(compression, bomb, 64 * MEBIBYTE) == bytes(64 * MEBIBYTE)


def test_a_packed_message_unpacks_to_its_limit():
    packed = zstd().compress(b"x" * 100)
    assert decompress_zstd(packed, 100) == b"x" * 100
    with pytest.raises(reader.DamageError, match="more than 99 bytes"):
        decompress_zstd(packed, 99)


def test_a_message_that_is_not_packed_as_its_bag_says(tmp_path):
    folder = ros2_bag(tmp_path / "run", "mcap")
    metadata = "  compression_mode: MESSAGE\n  compression_format: zstd\n"
    (folder / "metadata.yaml").write_text(METADATA + metadata)
    assert "no zstd" in fault(folder)


@pytest.mark.parametrize("text", ["", "x", "- " * 10**5, "- depth: x\n", "-\n" * 100])
def test_qos_that_is_none(text):
    assert set(parse_offered_qos(text)) <= {QoS()}


def test_qos_of_so_many_publishers():
    assert len(parse_offered_qos("- depth: 1\n" * 100)) == 100
    assert parse_offered_qos("- depth: 7\n" * 101) == (QoS(depth=7),) * 100


def test_a_bag_may_unpack_to_so_many_times_its_size(tmp_path, monkeypatch):
    data = b"".join(ros1_message_record(0, 1, bytes(1000)) for _ in range(1000))
    packed = bz2.compress(data)
    chunks = [chunk1(packed, compression=b"bz2", size=len(data))] * 5
    path = write_ros1_records(tmp_path / "x.bag", chunks)
    monkeypatch.setattr("rtron.sources.bag.common.reader._MIN_BUDGET_BYTES", 5 * len(data))
    monkeypatch.setattr("rtron.sources.bag.common.reader._MAX_RATIO", 10)
    assert len(list(open_bag(path))) == 5000
    monkeypatch.setattr("rtron.sources.bag.common.reader._MIN_BUDGET_BYTES", 5 * len(data) - 1)
    assert "10 times its size" in fault(path)


def test_messages_in_a_chunk_are_counted(tmp_path, monkeypatch):
    data = ros1_message_record(0, 1, b"") * 4
    ros1_path = write_ros1_records(tmp_path / "x.bag", [chunk1(data)])
    summary = schema() + channel()
    mcap_path = write_mcap_records(
        tmp_path / "x.mcap",
        summary,
        chunks=[(1, mcap_chunk_record(1, mcap_message_record(1, 1, b"") * 4))],
    )
    for module in (reader, mcap_record_module):
        monkeypatch.setattr(module, "MAX_CHUNK_MESSAGES", 5)
    assert len(list(open_bag(ros1_path))) == len(list(open_bag(mcap_path))) == 4
    for module in (reader, mcap_record_module):
        monkeypatch.setattr(module, "MAX_CHUNK_MESSAGES", 3)
    assert "more than 3 messages" in fault(ros1_path)
    assert "more than 3 messages" in fault(mcap_path)


def test_an_index_larger_than_allowed(tmp_path, monkeypatch):
    path = ros1_bag(tmp_path / "x.bag")
    monkeypatch.setattr(ros1_record_module.RecordReader.__init__, "__defaults__", (300,))
    assert "an index of more than" in fault(path)


def test_connections_are_counted(tmp_path, monkeypatch):
    path = ros1_bag(tmp_path / "x.bag")
    monkeypatch.setattr(reader, "MAX_CONNECTIONS", 2)
    assert len(list(open_bag(path))) == 100
    monkeypatch.setattr(reader, "MAX_CONNECTIONS", 1)
    assert "more than 1 connections" in fault(path)


@pytest.mark.parametrize(
    ("summary", "more", "said"),
    [
        (b"", {"chunks": [(1, mcap_chunk_record(1, b""))]}, "names no channels"),
        (b"", {"start": 0}, "no summary"),
        (b"", {"start": 2**63}, "not where it should be"),
        (b"", {"start": 1}, "not where it should be"),
        (mcap_record(3, b"x"), {}, "shorter than its values"),
        (b"\x04" + b"\xff" * 8, {}, "longer than what it is in"),
        (mcap_record(4, struct.pack("<HHI", 1, 1, 2**32 - 1)), {}, "shorter than its values"),
        (channel(metadata={"a": "b"})[:-1] + b"\xff", {}, "can't decode"),
        (channel(), {"body": mcap_message_record(9, 1, b"")}, "no channel (9)"),
        (channel(), {"body": mcap_message_record(1, 2, b"") + mcap_message_record(1, 1, b"")},
         "out of order"),
        (channel(), {"body": mcap_chunk_record(1, b"")[0]}, "does not say where its chunks are"),
        (channel(), {"body": struct.pack("<BQ", 5, 2**62)}, "a record of"),
        (channel(), {"body": struct.pack("<BQH", 5, 2**20, 1)}, "cut off"),
        (channel(), {"chunks": [(1, mcap_chunk_record(1, b"x" * 9, compression="zstd"))]},
         "no zstd"),
        (channel(), {"chunks": [(1, mcap_chunk_record(1, b"x" * 9, size=8))]}, "does not unpack"),
        (channel(), {"chunks": [(1, mcap_chunk_record(1, mcap_message_record(9, 1, b"")))]},
         "no channel (9)"),
        (channel(), {"chunks": [(1, mcap_chunk_record(1, mcap_message_record(1, 1, b"xyz")[:-1]))]},
         "longer than its"),
        (channel(), {"chunks": [(2, mcap_chunk_record(1, mcap_message_record(1, 1, b"")))]},
         "wrong time"),
        (channel(), {"chunks": [(2, mcap_chunk_record(1, b"", size=2**40))]},
         "unpacks to 1099511627776"),
        (channel(), {"chunks": [(2, (mcap_record(5, bytes(40)), 40))]}, "points to no chunk"),
    ],
)  # fmt: skip
def test_an_mcap_that_lies(tmp_path, summary, more, said):
    assert said in fault(write_mcap_records(tmp_path / "x.mcap", summary, **more))


def test_a_ros1_bag_that_was_cut_off(tmp_path):
    whole = ros1_bag(tmp_path / "run.bag").read_bytes()
    path = tmp_path / "cut.bag"
    for size in (14, 20, 5000, len(whole) - 1):
        path.write_bytes(whole[:size])
        assert "cut off" in fault(path)


def test_an_mcap_that_was_cut_off(tmp_path):
    whole = (ros2_bag(tmp_path / "run", "mcap") / "run.mcap").read_bytes()
    path = tmp_path / "cut.mcap"
    for size in (9, 36, len(whole) // 2, len(whole) - 1):
        path.write_bytes(whole[:size])
        assert "cut off" in fault(path)


TOPICS = "CREATE TABLE topics(id, name, type, serialization_format, offered_qos_profiles);"
MESSAGES = "CREATE TABLE messages(id, topic_id, timestamp, data);"
TOPIC = "INSERT INTO topics VALUES(1, '/t', 'x/msg/Y', 'cdr', '');"
ENDLESS = "WITH RECURSIVE r(x) AS (SELECT 1 UNION ALL SELECT x + 1 FROM r) SELECT"


def database(path, statements):
    with closing(sqlite3.connect(path)) as made:
        made.executescript(statements)
    return path


@pytest.mark.parametrize(
    ("statements", "said"),
    [
        ("CREATE TABLE x(y);", "no ROS 2 bag"),
        ("CREATE TABLE topics(id); CREATE TABLE messages(id);" + "INSERT INTO topics VALUES(1);",
         ""),
        (TOPICS + MESSAGES + TOPIC.replace("'/t'", "7"), "a name that is no text"),
        (TOPICS + MESSAGES + TOPIC.replace("1, '/t'", "'x', '/t'"), "id that is no number"),
        (TOPICS + MESSAGES + "INSERT INTO messages VALUES(1, 1, 1, x'00');", "has no 1"),
        (TOPICS + MESSAGES + TOPIC + "INSERT INTO messages VALUES(1, 1, 'x', x'00');", "message"),
        (TOPICS + MESSAGES + TOPIC + "INSERT INTO messages VALUES(1, 1, 1, 'text');", "message"),
        (TOPICS + MESSAGES + TOPIC + "INSERT INTO messages VALUES(1, 1, 1, NULL);", "message"),
        (
            TOPICS
            + f"CREATE VIEW messages AS {ENDLESS} x AS timestamp, x AS topic_id, x AS data FROM r;",
            "messages is no plain",
        ),
        (MESSAGES + f"CREATE VIEW topics AS {ENDLESS} x AS id FROM r;", "topics is no plain"),
        (TOPICS + "CREATE VIRTUAL TABLE messages USING fts5(data);", "messages is no plain"),
        (
            TOPICS + "CREATE TABLE messages(id, topic_id, timestamp, data AS (zeroblob(9)));"
            "INSERT INTO messages(id) VALUES(1);",
            "messages has columns that are computed",
        ),
    ],
)  # fmt: skip
def test_a_database_that_lies_or_computes(tmp_path, statements, said):
    assert said in fault(database(tmp_path / "x.db3", statements))


def test_a_table_of_topics_is_small(tmp_path, monkeypatch):
    path = database(tmp_path / "x.db3", TOPICS + MESSAGES + TOPIC * 9)
    monkeypatch.setattr(sqlite, "MAX_CONNECTIONS", 8)
    assert list(open_bag(path)) == []
    monkeypatch.setattr(sqlite, "MAX_CONNECTIONS", 7)
    assert "too large" in fault(path)
    monkeypatch.setattr(sqlite, "MAX_CONNECTIONS", 8)
    monkeypatch.setattr(sqlite, "MAX_INDEX_BYTES", 10)
    assert "too large" in fault(path)


def test_a_query_takes_so_many_steps(tmp_path, monkeypatch):
    rows = "INSERT INTO messages VALUES " + ", ".join(["(1, 1, 1, x'00')"] * 2000) + ";"
    path = database(tmp_path / "x.db3", TOPICS + MESSAGES + TOPIC + rows)
    assert len(list(open_bag(path))) == 2000
    monkeypatch.setattr(sqlite, "_MIN_STEPS", 0)
    monkeypatch.setattr(sqlite, "_STEPS_PER_BYTE", 0)
    monkeypatch.setattr(sqlite, "_STEPS_PER_CHECK", 1000)
    assert "interrupted" in fault(path)


METADATA = """rosbag2_bagfile_information:
  version: 9
  storage_identifier: mcap
  relative_file_paths:
    - run.mcap
"""


@pytest.mark.parametrize(
    ("fake_study", "replaced", "said"),
    [
        ("- run.mcap", "- ../secret.mcap", "'../secret.mcap', which is not in the folder"),
        ("- run.mcap", "- ..", "which is not in the folder"),
        ("- run.mcap", "- /etc/passwd", "which is not in the folder"),
        ("- run.mcap", "- pipe.mcap", "which is not in the folder"),
        ("- run.mcap", "- !!python/object/apply:os.system [ls]", "which is not in the folder"),
        ("    - run.mcap", "    x", "does not list the files"),
        ("    - run.mcap", "    []", "does not list the files"),
        ("identifier: mcap", "identifier: rocksdb", "storage_identifier is unknown"),
        ("identifier: mcap", "identifier: [mcap]", "storage_identifier is unknown"),
        ("rosbag2_bagfile_information", "x", "has no rosbag2_bagfile_information"),
        (METADATA, "", "has no rosbag2_bagfile_information"),
        (METADATA, "a: [" * 200, "more than 100 levels"),
        (METADATA, "- {", "not YAML"),
        (METADATA, "\x00", "not YAML"),
        ("version: 9", "compression_mode: FILE", "packed as a whole"),
        ("version: 9", "compression_mode: MESSAGE", "not by zstd"),
    ],
)
def test_metadata_that_lies(tmp_path, fake_study, replaced, said):
    folder = ros2_bag(tmp_path / "run", "mcap")
    (tmp_path / "secret.mcap").write_bytes((folder / "run.mcap").read_bytes())
    os.mkfifo(folder / "pipe.mcap")
    (folder / "metadata.yaml").write_text(METADATA)
    assert len(list(open_bag(folder))) == 100
    (folder / "metadata.yaml").write_text(METADATA.replace(fake_study, replaced))
    assert said in fault(folder)


def test_metadata_that_multiplies(tmp_path):
    laughs = "\n".join(
        ["a0: &a0 [x]", *(f"a{n}: &a{n} [{', '.join([f'*a{n - 1}'] * 10)}]" for n in range(1, 12))]
    )
    folder = tmp_path / "run"
    folder.mkdir()
    (folder / "metadata.yaml").write_text(f"rosbag2_bagfile_information: 1\n{laughs}\n")
    assert "more than 100000 values" in fault(folder)


@pytest.fixture(scope="module")
def good(tmp_path_factory):
    folder = tmp_path_factory.mktemp("good")
    ros1_bag(folder / "plain.bag", chunk=500)
    ros1_bag(folder / "bz2.bag", packed="bz2", chunk=500)
    ros1_bag(folder / "lz4.bag", packed="lz4", chunk=500)
    for storage, suffix in (("mcap", "mcap"), ("sqlite3", "db3")):
        made = ros2_bag(folder / storage, storage) / f"{storage}.{suffix}"
        made.rename(folder / f"ros2.{suffix}")
    made = ros2_bag(folder / "packed", "mcap", mode="storage") / "packed.mcap"
    made.rename(folder / "packed.mcap")
    return {path.name: path.read_bytes() for path in folder.iterdir() if path.is_file()}


def read_what_can_be(path):
    """Return how many messages there are, and the InputError if there is one."""
    found = 0
    try:
        for _ in open_bag(path):
            found += 1
    except InputError as error:
        return found, error
    return found, None


@pytest.mark.parametrize(
    "name", ["plain.bag", "bz2.bag", "lz4.bag", "ros2.mcap", "packed.mcap", "ros2.db3"]
)
@settings(
    max_examples=examples(150),
    deadline=None,
    suppress_health_check=[HealthCheck.function_scoped_fixture],
)
@given(seed=st.integers(0, 2**32), number=st.integers(1, 8), cut=st.booleans())
def test_random_damage_is_an_input_error_or_does_no_harm(tmp_path, good, name, seed, number, cut):
    random_numbers = random.Random(seed)
    data = bytearray(good[name])
    for _ in range(number):
        data[random_numbers.randrange(len(data))] = random_numbers.randrange(256)
    if cut:
        del data[random_numbers.randrange(len(data)) :]
    path = tmp_path / name
    path.write_bytes(data)
    found, error = read_what_can_be(path)
    assert found <= 200
    assert error is None or (str(error).startswith(str(path)) and error.help)
