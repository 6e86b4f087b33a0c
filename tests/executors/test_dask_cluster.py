import socket
import subprocess
import sys
from threading import Thread
from types import SimpleNamespace

import pytest
from executor_work import fail_at_three, kill_at_three, square, wait_for_other
from local_cluster import local_cluster

from rtron.errors import InputError, SourceError
from rtron.executors import DaskExecutor, ItemFailure, ProcessExecutor, SerialExecutor
from rtron.executors import dask_cluster as module
from rtron.executors.chunked_map import CHUNK_SIZE, map_in_order
from rtron.functions.classifier.pipeline import classify
from rtron.functions.repository import SourcePackage, SourceRepository

NAMES = ("amcl", "laser_filters", "joy_teleop", "velodyne_driver", "zzz", "octomap_mapping")


def repositories(number):
    return [
        SourceRepository(
            name=f"{NAMES[n % len(NAMES)]}_{n}",
            packages=(
                SourcePackage(name=NAMES[n % 5], description="A driver for a laser scanner."),
            ),
            readme="# Maps\nBuilds an occupancy grid.",
        )
        for n in range(number)
    ]


@pytest.fixture(scope="module")
def address():
    pytest.importorskip("distributed", reason="the extra `cluster` is not installed")
    with local_cluster() as found:
        yield found


def test_results_are_those_of_processes_and_of_one_process(address):
    items = repositories(5 * CHUNK_SIZE + 1)
    here = list(SerialExecutor().map(classify, items))
    assert list(DaskExecutor(address).map(classify, items)) == here
    assert list(ProcessExecutor(2).map(classify, items)) == here
    assert {each.primary for each in here} - {None}


def test_the_command_says_the_same_with_a_cluster(address, tmp_path):
    corpus = tmp_path / "corpus.jsonl"
    corpus.write_text("".join(f'{{"repo": "{name}"}}\n' for name in NAMES))
    command = [sys.executable, "-m", "rtron", "classify", corpus]
    alone = subprocess.run(command, capture_output=True, check=True)
    together = subprocess.run([*command, "--cluster", address], capture_output=True, check=True)
    assert together.stdout == alone.stdout
    assert (alone.stdout.count(b"\n"), together.stderr) == (len(NAMES), b"")


def test_results_of_workers_come_as_they_are_done(address):
    wanted = {0: 0, 1: 1, 2: 2, 3: ItemFailure("ValueError: three"), 4: 4}
    assert dict(DaskExecutor(address).map_unordered(fail_at_three, range(5))) == wanted


def test_both_workers_work_at_a_time(address, tmp_path):
    met = set(DaskExecutor(address, chunk_size=1).map(wait_for_other, [str(tmp_path)] * 2))
    assert len(met - {None}) == 2


def test_an_item_that_fails_costs_itself_only_on_a_cluster(address):
    wanted = [0, 1, 2, ItemFailure("ValueError: three"), *range(4, 40)]
    assert list(DaskExecutor(address).map(fail_at_three, range(40))) == wanted


def test_nothing_to_do_on_a_cluster(address):
    assert list(DaskExecutor(address).map(square, [])) == []


@pytest.mark.long
def test_an_item_that_ends_its_worker_costs_itself_only():
    pytest.importorskip("distributed", reason="the extra `cluster` is not installed")
    with local_cluster(3) as address:  # it ends two, the third need not be started again
        found = list(DaskExecutor(address, timeout_s=60).map(kill_at_three, range(6)))
    assert found == [0, 1, 2, ItemFailure("the process that worked on it ended"), 4, 5]


def test_a_cluster_without_workers():
    pytest.importorskip("distributed", reason="the extra `cluster` is not installed")
    with local_cluster(0) as address, pytest.raises(SourceError, match="has no workers") as raised:
        list(DaskExecutor(address, timeout_s=5).map(square, [1]))
    assert raised.value.help == f"dask worker {address}"


def test_workers_with_another_rtron(address, monkeypatch):
    monkeypatch.setattr(module, "__version__", "0.0.0")
    with pytest.raises(SourceError, match=r"workers have rtron .+, not 0\.0\.0"):
        list(DaskExecutor(address).map(square, [1]))


def test_an_address_where_nobody_answers():
    pytest.importorskip("distributed", reason="the extra `cluster` is not installed")
    with pytest.raises(SourceError, match=r"no cluster answers at tcp://127\.0\.0\.1:1") as raised:
        list(DaskExecutor("tcp://127.0.0.1:1", timeout_s=0.2).map(square, [1]))
    assert "dask scheduler" in raised.value.help


@pytest.mark.parametrize("closes", [False, True], ids=["silent", "closing"])
def test_an_address_where_something_else_listens(closes):
    pytest.importorskip("distributed", reason="the extra `cluster` is not installed")
    with socket.create_server(("127.0.0.1", 0)) as server:

        def close():
            server.accept()[0].close()

        if closes:
            Thread(target=close, daemon=True).start()
        port = server.getsockname()[1]
        with pytest.raises(SourceError, match="no cluster answers"):
            list(DaskExecutor(f"tcp://127.0.0.1:{port}", timeout_s=0.2).map(square, [1]))


def test_a_name_that_no_host_has():
    pytest.importorskip("distributed", reason="the extra `cluster` is not installed")
    with pytest.raises(SourceError, match="no cluster answers"):
        list(DaskExecutor(f"tcp://{'x' * 64}..invalid:1", timeout_s=0.2).map(square, [1]))


@pytest.mark.parametrize(
    "address",
    ["nonsense://x:1", "tcp://host:port", "tcp://host", "tcp://:1", "tcp://[x:1", "host:1", ""],
)
def test_what_is_no_address(address):
    pytest.importorskip("distributed", reason="the extra `cluster` is not installed")
    with pytest.raises(InputError, match="no cluster's address"):
        list(DaskExecutor(address, timeout_s=5).map(square, [1]))


def test_without_dask_the_extra_is_named(monkeypatch):
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(InputError, match="needs Dask") as raised:
        list(DaskExecutor("tcp://127.0.0.1:1").map(square, [1]))
    assert raised.value.help == 'pip install "rtron[cluster]"'


def test_a_cluster_that_falls_silent():
    class GoneError(Exception):
        """Stands for one of Dask's."""

    def gone(*_, **__):
        raise GoneError("closed")

    for submit in (gone, lambda *_, **__: SimpleNamespace(result=gone)):
        client = SimpleNamespace(submit=submit)
        workers = module._DaskWorkers(SimpleNamespace(KilledWorker=KeyError), client, 1)
        with pytest.raises(SourceError, match="the cluster failed: GoneError: closed"):
            list(map_in_order(workers, square, [1]))
