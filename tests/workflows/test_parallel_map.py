"""Where a command about many things works."""

import pytest

from rtron.errors import InputError
from rtron.executors import DaskExecutor, ProcessExecutor, SerialExecutor
from rtron.workflows.classification import choose_executor


@pytest.fixture(autouse=True)
def three_cores(monkeypatch):
    monkeypatch.setattr("rtron.sources.static.common.scan_options.default_workers", lambda: 3)


@pytest.mark.parametrize(
    ("jobs", "cluster", "worth", "chosen"),
    [
        (None, None, True, ProcessExecutor(3, 5)),
        (2, None, True, ProcessExecutor(2, 5)),
        (2, None, False, ProcessExecutor(2, 5)),
        (3, None, False, ProcessExecutor(3, 5)),
        (4, None, False, ProcessExecutor(3, 5)),
        (100_000, None, True, ProcessExecutor(3, 5)),
        (None, "tcp://host:1", False, DaskExecutor("tcp://host:1", 5)),
    ],
)
def test_what_is_asked_for_or_worth_it(jobs, cluster, worth, chosen):
    assert choose_executor(jobs, cluster, chunk=5, is_worth_parallel=worth) == chosen


@pytest.mark.parametrize(("jobs", "worth"), [(1, True), (1, False), (None, False)])
def test_one_process_is_this_one(jobs, worth):
    assert isinstance(choose_executor(jobs, None, chunk=5, is_worth_parallel=worth), SerialExecutor)


def test_the_only_core_takes_one_process(monkeypatch):
    monkeypatch.setattr("rtron.sources.static.common.scan_options.default_workers", lambda: 1)
    assert isinstance(
        choose_executor(100_000, None, chunk=5, is_worth_parallel=True), SerialExecutor
    )


def test_both_are_one_too_many():
    with pytest.raises(InputError, match="both"):
        choose_executor(1, "tcp://host:1", chunk=5, is_worth_parallel=True)
