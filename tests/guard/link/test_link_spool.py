"""Events on disk: once, in order, within a bound, and not lost with the process."""

import os
import signal
import sqlite3
import subprocess
import sys

import pytest
from harness import is_open
from link_parts import encoded_events, event

from rtron.errors import InputError
from rtron.guard.link.event_recorder import EventCounter, forget_run, former_runs
from rtron.guard.link.spool import Spool
from rtron.vocabulary import EventKind


@pytest.fixture
def spool(tmp_path):
    spool = Spool(tmp_path / "events.sqlite", max_events=3)
    yield spool
    spool.close()


def numbers(spool, after=0):
    return [(run, number) for _, run, number, _ in spool.events_after(after, 100)]


def test_events_come_out_as_they_went_in(spool):
    spool.add(encoded_events(event(1), event(2), event(1, "other")))
    assert numbers(spool) == [("run", 1), ("run", 2), ("other", 1)]
    assert spool.waiting == 3


def test_an_event_that_comes_again_is_not_kept_again(spool):
    spool.add(encoded_events(event(1), event(2)))
    spool.add(encoded_events(event(1), event(2), event(3)))
    assert numbers(spool) == [("run", 1), ("run", 2), ("run", 3)]
    spool.forget("run", 3)
    spool.add(encoded_events(event(3)))
    assert numbers(spool) == []


def test_what_the_service_has_is_forgotten(spool):
    spool.add(encoded_events(event(1), event(2), event(1, "other")))
    spool.forget("run", 1)
    assert numbers(spool) == [("run", 2), ("other", 1)]
    assert spool.waiting == 2
    assert not spool.is_empty.is_set()
    spool.forget("run", 2)
    spool.forget("other", 9)
    assert spool.is_empty.is_set()


def test_what_cannot_be_kept_leaves_everything_as_it_was(spool):
    spool.add(encoded_events(event(1)))
    with pytest.raises(sqlite3.Error):
        spool.add([*encoded_events(event(2)), (event(3), None)])
    assert (numbers(spool), spool.waiting, spool.highest_number("run")) == ([("run", 1)], 1, 1)
    spool.add(encoded_events(event(2)))
    assert numbers(spool) == [("run", 1), ("run", 2)]


def test_reading_goes_on_behind_a_position(spool):
    spool.add(encoded_events(event(1), event(2)))
    position = spool.events_after(0, 1)[0][0]
    assert numbers(spool, after=position) == [("run", 2)]


@pytest.mark.parametrize(("kind", "kept"), [(EventKind.COUNTS, 3), (EventKind.VERDICT, 6)])
def test_counts_are_the_first_to_find_no_place(spool, kind, kept):
    spool.add(encoded_events(*(event(n, kind=kind) for n in range(1, 10))))
    assert spool.waiting == kept
    assert spool.lost == 9 - kept


def test_what_was_lost_is_told_once_there_is_place(spool):
    spool.add(encoded_events(*(event(n) for n in range(1, 10))))
    assert spool.take_lost() == 0
    spool.forget("run", 4)
    assert spool.take_lost() == 3
    assert spool.take_lost() == 0


def test_what_was_lost_is_known_to_the_next_process(tmp_path):
    spool = Spool(tmp_path / "events.sqlite", max_events=1)
    spool.add(encoded_events(event(1), event(2), event(3)))
    spool.close()
    again = Spool(tmp_path / "events.sqlite", max_events=3)
    assert (again.waiting, again.lost, again.run) == (2, 1, spool.run)
    assert again.take_lost() == 1
    again.close()


def test_losses_are_events_of_the_links_own_run(spool):
    first = spool.report_lost(5, 7, "because", "run")
    spool.add(encoded_events(first))
    second = spool.report_lost(6, 1, "because")
    assert (first.number, second.number) == (1, 2)
    assert first.values == {"events": 7, "run": "run"}
    assert first.run == second.run != "run"


def test_numbers_of_runs_that_are_over_are_forgotten(spool):
    spool.add(
        encoded_events(event(5), event(3, "waits"), event(2, "now"), spool.report_lost(1, 1, "x"))
    )
    spool.forget("run", 5)
    spool.forget("now", 2)
    spool.forget(spool.run, 1)
    spool.prune("now")
    assert [spool.highest_number(run) for run in ("run", "waits", "now", spool.run)] == [0, 3, 2, 1]


def test_a_file_that_is_no_database_is_told(tmp_path):
    path = tmp_path / "events.sqlite"
    path.write_bytes(b"not a database at all, only text" * 100)
    with pytest.raises(InputError, match="not a database") as error:
        Spool(path)
    assert "--state-dir" in error.value.help
    assert not is_open(path)


WRITER = """
import sys
sys.path[:0] = sys.argv[2:]
from pathlib import Path
from link_parts import encoded_events, event
from rtron.guard.link.spool import Spool
spool = Spool(Path(sys.argv[1]))
for number in range(1, 100000):
    spool.add(encoded_events(event(number)))
    print(number, flush=True)
"""


def test_a_kill_takes_nothing_that_was_confirmed(tmp_path):
    path = tmp_path / "events.sqlite"
    words = [sys.executable, "-c", WRITER, path, *sys.path]
    with subprocess.Popen(words, stdout=subprocess.PIPE, text=True) as writer:
        confirmed = [int(writer.stdout.readline()) for _ in range(200)][-1]
        os.kill(writer.pid, signal.SIGKILL)
        confirmed = max([confirmed, *map(int, writer.stdout.read().split())])
    spool = Spool(path)
    kept = [number for _, number in numbers_of(spool)]
    assert kept == list(range(1, len(kept) + 1))
    assert len(kept) >= confirmed
    spool.close()


def numbers_of(spool):
    return [(run, number) for _, run, number, _ in spool.events_after(0, 1_000_000)]


def test_a_run_counts_where_a_kill_does_not_reach(tmp_path):
    counter = EventCounter(tmp_path, "one")
    assert [counter.next(), counter.next()] == [1, 2]
    EventCounter(tmp_path, "two")
    (tmp_path / "torn").write_bytes(b"123")
    assert list(former_runs(tmp_path, "two")) == [("one", 2)]
    forget_run(tmp_path, "one")
    forget_run(tmp_path, "one")
    assert list(former_runs(tmp_path, "two")) == []
