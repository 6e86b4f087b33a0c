import itertools
import threading
from threading import Event

import pytest
from executor_work import (
    fail_at_three,
    kill_at_three,
    process_id,
    recurse_at_three,
    square,
    wait_for_other,
)
from harness import wait_for

from rtron.executors import ItemFailure, ProcessExecutor, SerialExecutor, ThreadExecutor
from rtron.executors.chunked_map import CHUNK_SIZE, CHUNKS_PER_WORKER, LostWorkerError, map_in_order

EVERY = [SerialExecutor(), ProcessExecutor(1), ProcessExecutor(2)]


@pytest.mark.parametrize("executor", EVERY, ids=["here", "one", "two"])
@pytest.mark.parametrize("number", [0, 1, CHUNK_SIZE, 2 * CHUNKS_PER_WORKER * CHUNK_SIZE + 1])
def test_results_come_in_the_items_order(executor, number):
    assert list(executor.map(square, range(number))) == [n * n for n in range(number)]


@pytest.mark.parametrize("executor", EVERY, ids=["here", "one", "two"])
def test_an_item_that_fails_costs_itself_only(executor):
    wanted = [0, 1, 2, ItemFailure("ValueError: three"), *range(4, 40)]
    assert list(executor.map(fail_at_three, range(40))) == wanted


@pytest.mark.parametrize("executor", [SerialExecutor(), ProcessExecutor(2)], ids=["here", "two"])
def test_an_item_that_recurses_without_end_costs_itself_only(executor):
    assert list(executor.map(recurse_at_three, range(5))) == [
        0,
        1,
        2,
        ItemFailure("nested too deep"),
        4,
    ]


def test_an_item_that_ends_its_process_costs_itself_only():
    ended = ItemFailure("the process that worked on it ended")
    number = 4 * CHUNKS_PER_WORKER * CHUNK_SIZE
    found = list(ProcessExecutor(2).map(kill_at_three, range(number)))
    assert found == [0, 1, 2, ended, *range(4, number)]


def test_several_processes_work_at_a_time(tmp_path):
    met = set(ProcessExecutor(2, chunk_size=1).map(wait_for_other, [str(tmp_path)] * 2))
    assert len(met - {None}) == 2


def test_processes_end_with_the_map():
    results = ProcessExecutor(1).map(process_id, itertools.count())
    assert next(results)
    results.close()
    assert list(ProcessExecutor(1).map(square, [2])) == [4]


class CountingWorkers:
    """Workers that do everything at once, and count what they were given before it was asked."""

    count = 2

    def __init__(self, lose=frozenset()):
        self.under_way = self.most = 0
        self.lose = lose

    def submit(self, function, *arguments):
        self.under_way += 1
        self.most = max(self.most, self.under_way)
        return lambda: self.answer(function, *arguments)

    def answer(self, function, work, items):
        self.under_way -= 1
        if self.lose & set(items):
            raise LostWorkerError
        return function(work, items)


def test_no_more_is_under_way_than_the_workers_need():
    workers = CountingWorkers()
    taken = []
    items = (taken.append(n) or n for n in range(100 * CHUNK_SIZE))
    results = map_in_order(workers, square, items)
    assert next(results) == 0
    assert len(taken) == CHUNKS_PER_WORKER * workers.count * CHUNK_SIZE
    assert sum(1 for _ in results) == 100 * CHUNK_SIZE - 1
    assert workers.most == CHUNKS_PER_WORKER * workers.count


def test_the_items_of_a_lost_chunk_are_tried_alone():
    results = list(map_in_order(CountingWorkers(lose={5}), square, range(2 * CHUNK_SIZE)))
    assert [n for n, result in enumerate(results) if isinstance(result, ItemFailure)] == [5]
    assert results[CHUNK_SIZE:] == [n * n for n in range(CHUNK_SIZE, 2 * CHUNK_SIZE)]


def test_a_long_item_keeps_no_short_one_waiting():
    others_done = Event()

    def work(number):
        if number == 0:
            others_done.wait(60)
        return number

    results = ThreadExecutor(2).map_unordered(work, range(4))
    assert {next(results) for _ in range(3)} == {(1, 1), (2, 2), (3, 3)}
    others_done.set()
    assert list(results) == [(0, 0)]


def test_an_item_that_fails_in_a_thread_costs_itself_only():
    results = dict(ThreadExecutor(2).map_unordered(fail_at_three, range(5)))
    assert results == {0: 0, 1: 1, 2: 2, 3: ItemFailure("ValueError: three"), 4: 4}


def test_who_stops_early_starts_no_further_item():
    started, gate = [], Event()

    def work(number):
        started.append(number)
        if number:
            gate.wait(60)

    before = set(threading.enumerate())
    results = ThreadExecutor(1).map_unordered(work, range(1000))
    assert next(results) == (0, None)
    results.close()
    gate.set()
    wait_for(lambda: set(threading.enumerate()) <= before)
    assert len(started) <= 2  # the one that was begun meanwhile
