"""The ring on disk, and the files that are made of it, read back with the library of the format."""

import os
import subprocess
import sys
from pathlib import Path

import pytest
from mcap.reader import make_reader

from rtron.guard.incidents.incident_folder import PART, read_segment, write_incident
from rtron.guard.incidents.ring import Channel, IncidentRing
from rtron.vocabulary import SECOND

WORDS = Channel("/rtron/words", "json", "Words", "jsonschema", '{"type":"object"}')
OTHER = Channel("/rtron/other", "json", "Words", "jsonschema", '{"type":"object"}', (("a", "b"),))
START = 1_700_000_000 * SECOND
BYTES = 1 << 20
OFFSET = 7 * SECOND


@pytest.fixture
def ring_in():
    """Return what makes a ring; all of them are closed at the end."""
    made = []

    def make(folder, span=60 * SECOND, max_bytes=BYTES):
        made.append(IncidentRing(folder, span=span, max_bytes=max_bytes, profile="ros2"))
        return made[-1]

    yield make
    for ring in made:
        ring.close()


def content(paths):
    return [message.data for path in paths for _, message in read_segment(path)]


def size_of(folder):
    return sum(path.stat().st_size for path in folder.iterdir())


def test_what_was_added_can_be_read_once_it_is_flushed(ring_in, tmp_path):
    ring = ring_in(tmp_path)
    ring.add(WORDS, START, b'{"a":1}')
    ring.add(OTHER, START + 1, b'{"a":2}')
    ((first, message), (second, _)) = [each for path in ring.paths() for each in read_segment(path)]
    assert (first, second) == (WORDS, OTHER)
    assert (message.log_time, message.data) == (START, b'{"a":1}')


@pytest.mark.parametrize("size", [1, 500, 1 << 16])
def test_the_ring_is_bounded_whatever_arrives(ring_in, tmp_path, size):
    ring = ring_in(tmp_path)
    for number in range(3 * BYTES // size if size > 1 else 20_000):
        ring.add(WORDS, START + number, bytes(size))
    ring.flush()
    assert size_of(tmp_path) <= BYTES
    assert size_of(tmp_path) > BYTES // 2
    ring.close()
    assert size_of(tmp_path) <= BYTES


def test_what_is_older_than_the_span_makes_room(ring_in, tmp_path):
    ring = ring_in(tmp_path, span=10 * SECOND)
    for second in range(100):
        ring.add(WORDS, START + second * SECOND, str(second).encode())
    left = [int(data) for data in content(ring.paths())]
    assert left == list(range(left[0], 100))
    assert 85 <= left[0] <= 89


def test_messages_that_are_a_little_out_of_order_need_no_other_segment(ring_in, tmp_path):
    ring = ring_in(tmp_path)
    for number in range(100):
        ring.add(WORDS, START + number - 50 * (number % 2), b"%d" % number)
    assert content(ring.paths()) == [b"%d" % number for number in range(100)]
    assert len(ring.paths()) == 1


def test_the_next_recorder_goes_on_with_what_is_there(ring_in, tmp_path):
    ring_in(tmp_path).add(WORDS, START, b"unflushed")
    ring = ring_in(tmp_path)
    ring.add(WORDS, START + SECOND, b"first")
    ring.close()
    after = ring_in(tmp_path)
    after.add(WORDS, START + 2 * SECOND, b"second")
    assert content(after.paths())[-2:] == [b"first", b"second"]


KILLED = """
import os, signal, sys
from pathlib import Path
from rtron.guard.incidents.ring import Channel, IncidentRing
ring = IncidentRing(Path(sys.argv[1]), span=60 * 10**9, max_bytes=1 << 20, profile="ros1")
for number in range(100):
    ring.add(Channel("/w", "json", "W", "jsonschema", "{}"), number, str(number).encode())
    ring.flush()
os.kill(os.getpid(), signal.SIGKILL)
"""


def test_a_killed_recorder_leaves_all_that_it_had_flushed(tmp_path):
    environ = os.environ | {"PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
    command = [sys.executable, "-c", KILLED, str(tmp_path)]
    assert subprocess.run(command, env=environ, check=False).returncode == -9
    assert content(sorted(tmp_path.iterdir())) == [str(number).encode() for number in range(100)]


def test_a_torn_end_costs_the_torn_record_only(ring_in, tmp_path):
    ring = ring_in(tmp_path)
    for number in range(10):
        ring.add(WORDS, START + number, b"%d" % number)
    (path,) = ring.paths()
    whole = path.read_bytes()
    for cut in range(1, 60):
        path.write_bytes(whole[:-cut])
        found = content([path])
        assert found == [b"%d" % number for number in range(len(found))]
        assert len(found) >= 10 - 1 - cut // 32


def saved(target, paths, begin, end, metadata=None):
    for _ in write_incident(paths, target, (begin, end, OFFSET), metadata or {}, "ros2"):
        pass


def test_an_incident_is_one_file_with_index_schemas_and_metadata(ring_in, tmp_path):
    folder = tmp_path / "ring"
    folder.mkdir()
    ring = ring_in(folder, span=800 * SECOND)
    for second in range(100):
        ring.add(WORDS if second % 2 else OTHER, START + second * SECOND, b"%d" % second)
    target = tmp_path / "incident.mcap"
    saved(target, ring.paths(), START + 20 * SECOND, START + 30 * SECOND, {"why": {"a": "b"}})
    with target.open("rb") as stream:
        reader = make_reader(stream)
        found = [(channel.topic, message.data) for _, channel, message in reader.iter_messages()]
        assert [data for _, data in found] == [b"%d" % second for second in range(20, 31)]
        assert {topic for topic, _ in found} == {"/rtron/words", "/rtron/other"}
        statistics = reader.get_summary().statistics
        assert statistics.message_count == 11
        assert statistics.message_start_time == START + 20 * SECOND + OFFSET
        assert [each.metadata for each in reader.iter_metadata()] == [{"a": "b"}]
    assert not list(tmp_path.glob(f"*{PART}"))


def test_a_segment_that_made_room_meanwhile_is_left_out(ring_in, tmp_path):
    ring = ring_in(tmp_path)
    ring.add(WORDS, START, b"there")
    target = tmp_path / "incident.mcap"
    saved(target, [tmp_path / "gone.mcap", *ring.paths()], START, START)
    assert content([target]) == [b"there"]


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no /dev/full here")
@pytest.mark.parametrize("size", [1, 1 << 20])
def test_a_full_disk_is_an_error_and_the_next_message_a_new_try(
    ring_in, tmp_path, monkeypatch, size
):
    ring = ring_in(tmp_path)
    with monkeypatch.context() as patch:
        patch.setattr(Path, "open", lambda *_, **__: open("/dev/full", "wb"))  # noqa: PTH123, SIM115
        with pytest.raises(OSError, match="No space"):
            add_and_flush(ring, bytes(size))
    ring.add(WORDS, START + 1, b"kept")
    assert content(ring.paths()) == [b"kept"]


def add_and_flush(ring, data):
    """Fill a disk with a message: while it is added if it is long, or when it is flushed."""
    ring.add(WORDS, START, data)
    ring.flush()
