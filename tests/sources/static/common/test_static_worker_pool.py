import os
import signal
import subprocess
import sys
import threading

import pytest

from rtron.sources.declaration import NodeSite
from rtron.sources.static.common.task import InterpretationTask, TaskKind
from rtron.sources.static.common.worker_pool import WorkerPool
from rtron.sources.workspace import read_workspace


def tasks_in(folder, count):
    source = folder / "robot/scripts/teleop.py"
    return [
        InterpretationTask(
            kind=TaskKind.PYTHON, sources=(source,), site=NodeSite(name=f"/n{number}")
        )
        for number in range(count)
    ]


def names(result):
    return {declared.name for declared in result.interface.declarations}


def test_processes_that_end_cost_no_result(folder):
    pool = WorkerPool(read_workspace([folder], {}), 1, 60)
    found = {}
    for task, result in pool.run_tasks(tasks_in(folder, 3)):
        if not found:
            for process in list(pool._executor._processes):
                os.kill(process, signal.SIGKILL)
        found[task.site.name] = names(result)
    pool.close()
    assert found == {name: {"/cmd_vel", "/go"} for name in ("/n0", "/n1", "/n2")}


def test_no_more_processes_are_started_than_there_are_cores(folder, monkeypatch):
    monkeypatch.setattr("rtron.sources.static.common.worker_pool.default_workers", lambda: 2)
    pool = WorkerPool(read_workspace([folder], {}), 100_000, 60)
    assert sum(1 for _ in pool.run_tasks(tasks_in(folder, 3))) == 3
    assert len(pool._executor._processes) == 2
    pool.close()


def test_no_tasks_start_no_process(folder):
    pool = WorkerPool(read_workspace([folder], {}), 2, 60)
    assert list(pool.run_tasks([])) == []
    assert pool._executor is None


def test_a_pool_works_again_after_it_was_closed(folder):
    pool = WorkerPool(read_workspace([folder], {}), 2, 60)
    for _ in range(2):
        ((_, result),) = pool.run_tasks(tasks_in(folder, 1))
        pool.close()
        assert names(result) == {"/cmd_vel", "/go"}


def test_the_files_that_count_are_told(folder):
    pool = WorkerPool(read_workspace([folder], {}), 1, 60)
    source = folder / "robot/src/driver.cpp"
    task = InterpretationTask(kind=TaskKind.CPP, sources=(source,), site=NodeSite(name="/driver"))
    ((_, result),) = pool.run_tasks([task])
    pool.close()
    assert {path.rpartition("/")[2] for path, _ in result.files} >= {"driver.cpp", "names.h"}


STARTED = """
import sys
from pathlib import Path
from rtron.sources.static.common.worker_pool import WorkerPool
from rtron.sources.workspace import read_workspace
pool = WorkerPool(read_workspace([Path(sys.argv[1])], {}), 1, 60)
print(pool._start_executor(1)._mp_context.get_start_method())
"""


@pytest.mark.skipif(sys.platform != "linux", reason="elsewhere no process forks")
def test_a_process_without_threads_forks(folder):
    command = [sys.executable, "-c", STARTED, str(folder)]
    assert subprocess.run(command, capture_output=True, check=True).stdout == b"fork\n"


def test_a_process_with_threads_does_not_fork(folder):
    pool, done = WorkerPool(read_workspace([folder], {}), 1, 60), threading.Event()
    other = threading.Thread(target=done.wait)
    other.start()
    try:
        has_server = sys.platform == "linux" and sys.version_info >= (3, 11, 1)
        method = pool._start_executor(1)._mp_context.get_start_method()
        assert method == ("forkserver" if has_server else "spawn")
    finally:
        done.set()
        other.join()
        pool.close()
