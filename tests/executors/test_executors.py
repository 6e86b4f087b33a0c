import itertools

import pytest
from executor_work import end_at_three, fail_at_three, meet, process, recurse_at_three, square

from rtron.executors import Failed, Here, Processes
from rtron.executors.chunked_map import AHEAD, CHUNK, LostError, in_order

EVERY = [Here(), Processes(1), Processes(2)]


@pytest.mark.parametrize("executor", EVERY, ids=["here", "one", "two"])
@pytest.mark.parametrize("number", [0, 1, CHUNK, 2 * AHEAD * CHUNK + 1])
def test_results_come_in_the_items_order(executor, number):
    assert list(executor.map(square, range(number))) == [n * n for n in range(number)]


@pytest.mark.parametrize("executor", EVERY, ids=["here", "one", "two"])
def test_an_item_that_fails_costs_itself_only(executor):
    wanted = [0, 1, 2, Failed("ValueError: three"), *range(4, 40)]
    assert list(executor.map(fail_at_three, range(40))) == wanted


@pytest.mark.parametrize("executor", [Here(), Processes(2)], ids=["here", "two"])
def test_an_item_that_recurses_without_end_costs_itself_only(executor):
    assert list(executor.map(recurse_at_three, range(5))) == [0, 1, 2, Failed("nested too deep"), 4]


def test_an_item_that_ends_its_process_costs_itself_only():
    ended = Failed("the process that worked on it ended")
    number = 4 * AHEAD * CHUNK
    found = list(Processes(2).map(end_at_three, range(number)))
    assert found == [0, 1, 2, ended, *range(4, number)]


def test_several_processes_work_at_a_time(tmp_path):
    met = set(Processes(2, chunk=1).map(meet, [str(tmp_path)] * 2))
    assert len(met - {None}) == 2


def test_processes_end_with_the_map():
    results = Processes(1).map(process, itertools.count())
    assert next(results)
    results.close()
    assert list(Processes(1).map(square, [2])) == [4]


class Counting:
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
            raise LostError
        return function(work, items)


def test_no_more_is_under_way_than_the_workers_need():
    workers = Counting()
    taken = []
    items = (taken.append(n) or n for n in range(100 * CHUNK))
    results = in_order(workers, square, items)
    assert next(results) == 0
    assert len(taken) == AHEAD * workers.count * CHUNK
    assert sum(1 for _ in results) == 100 * CHUNK - 1
    assert workers.most == AHEAD * workers.count


def test_the_items_of_a_lost_chunk_are_tried_alone():
    results = list(in_order(Counting(lose={5}), square, range(2 * CHUNK)))
    assert [n for n, result in enumerate(results) if isinstance(result, Failed)] == [5]
    assert results[CHUNK:] == [n * n for n in range(CHUNK, 2 * CHUNK)]
