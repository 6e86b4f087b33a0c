"""Where a command about many things works."""

import pytest

from rtron.errors import InputError
from rtron.executors import Cluster, Here, Processes
from rtron.workflows.parallel_map import chosen_executor


@pytest.fixture(autouse=True)
def three_cores(monkeypatch):
    monkeypatch.setattr("rtron.sources.static.common.scan_options.default_workers", lambda: 3)


@pytest.mark.parametrize(
    ("jobs", "cluster", "worth", "chosen"),
    [
        (None, None, True, Processes(3, 5)),
        (2, None, True, Processes(2, 5)),
        (2, None, False, Processes(2, 5)),
        (3, None, False, Processes(3, 5)),
        (4, None, False, Processes(3, 5)),
        (100_000, None, True, Processes(3, 5)),
        (None, "tcp://host:1", False, Cluster("tcp://host:1", 5)),
    ],
)
def test_what_is_asked_for_or_worth_it(jobs, cluster, worth, chosen):
    assert chosen_executor(jobs, cluster, chunk=5, worth=worth) == chosen


@pytest.mark.parametrize(("jobs", "worth"), [(1, True), (1, False), (None, False)])
def test_one_process_is_this_one(jobs, worth):
    assert isinstance(chosen_executor(jobs, None, chunk=5, worth=worth), Here)


def test_the_only_core_takes_one_process(monkeypatch):
    monkeypatch.setattr("rtron.sources.static.common.scan_options.default_workers", lambda: 1)
    assert isinstance(chosen_executor(100_000, None, chunk=5, worth=True), Here)


def test_both_are_one_too_many():
    with pytest.raises(InputError, match="both"):
        chosen_executor(1, "tcp://host:1", chunk=5, worth=True)
