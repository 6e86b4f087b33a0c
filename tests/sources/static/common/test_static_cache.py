import os

import pytest

from rtron.sources.bounded_file import content_hash
from rtron.sources.declaration import NodeInterface, NodeSite
from rtron.sources.static.common.cache import (
    InterfaceCache,
    hash_workspace,
    open_cache,
    user_cache_folder,
)
from rtron.sources.static.common.launch_paths import find_launch_file
from rtron.sources.static.common.scan_options import ScanOptions
from rtron.sources.static.common.task import InterpretationTask, TaskKind, TaskResult
from rtron.sources.static.common.worker_pool import WorkerPool
from rtron.sources.static.ros1.app import scan_app
from rtron.sources.workspace import read_workspace


@pytest.fixture
def ran(monkeypatch):
    """Return the names of the nodes whose programs were interpreted."""
    names = []
    run = WorkerPool.run_tasks

    def watched(self, tasks):
        names.extend(task.site.name for task in tasks)
        return run(self, tasks)

    monkeypatch.setattr(WorkerPool, "run_tasks", watched)
    return names


def scan(folder, cache, **args):
    workspace = read_workspace([folder], {})
    launches = [(find_launch_file("robot/app.launch", workspace), args)]
    return scan_app([folder], launches, {}, ScanOptions(workers=1, cache=cache))


def test_a_warm_scan_interprets_nothing_and_finds_the_same(folder, tmp_path, ran):
    cold = scan(folder, tmp_path / "cache")
    assert sorted(ran) == ["/base/driver", "/teleop"]
    ran.clear()
    assert scan(folder, tmp_path / "cache") == cold
    assert ran == []


@pytest.mark.parametrize(
    ("file", "again"),
    [
        ("include/robot/names.h", ["/base/driver"]),
        ("src/driver.cpp", ["/base/driver"]),
        ("scripts/teleop.py", ["/teleop"]),
        ("scripts/boss.py", []),
        ("CMakeLists.txt", ["/base/driver", "/teleop"]),
        ("include/robot/new.h", ["/base/driver", "/teleop"]),
    ],
)
def test_what_a_change_makes_stale(folder, tmp_path, ran, file, again):
    scan(folder, tmp_path / "cache")
    ran.clear()
    with (folder / "robot" / file).open("a") as changed:
        changed.write("\n")
    scan(folder, tmp_path / "cache")
    assert sorted(ran) == again


def test_a_header_that_changes_counts(folder, tmp_path):
    scan(folder, tmp_path / "cache")
    (folder / "robot/include/robot/names.h").write_text('#define COMMAND "drive"\n')
    graph = scan(folder, tmp_path / "cache").graph
    assert "/base/drive" in {e.topic for e in graph.endpoints if e.node == "/base/driver"}


def test_parameters_belong_to_the_key(folder, tmp_path):
    scan(folder, tmp_path / "cache")
    graph = scan(folder, tmp_path / "cache", odom="other").graph
    assert "/base/other" in {topic.name for topic in graph.topics}


@pytest.mark.parametrize("content", [b"", b"{", b"null", b"\xff" * 9, b'{"interface":{"x":1}}'])
def test_a_spoilt_entry_is_no_entry(folder, tmp_path, ran, content):
    cold = scan(folder, tmp_path / "cache")
    for entry in (tmp_path / "cache").iterdir():
        entry.write_bytes(content)
    ran.clear()
    assert scan(folder, tmp_path / "cache") == cold
    assert sorted(ran) == ["/base/driver", "/teleop"]


def task_in(folder):
    source = folder / "robot/scripts/teleop.py"
    return InterpretationTask(
        kind=TaskKind.PYTHON, sources=(source,), site=NodeSite(name="/teleop")
    )


def result_of(task):
    files = tuple((str(path), content_hash(path)) for path in task.sources)
    return TaskResult(interface=NodeInterface(), files=files)


def test_a_link_in_the_cache_is_replaced_not_followed(folder, tmp_path):
    task, cache = task_in(folder), open_cache(tmp_path / "cache", "state")
    cache.put(task, result_of(task))
    (entry,) = (tmp_path / "cache").iterdir()
    precious = tmp_path / "precious"
    precious.write_text("mine")
    entry.unlink()
    entry.symlink_to(precious)
    cache.put(task, result_of(task))
    assert precious.read_text() == "mine"
    assert not entry.is_symlink()
    assert cache.get(task) == result_of(task)


def test_a_folder_that_others_can_write_or_that_is_a_link_is_not_used(folder, tmp_path):
    shared, real, link = (tmp_path / name for name in ("shared", "real", "link"))
    shared.mkdir()
    shared.chmod(0o777)
    real.mkdir(mode=0o700)
    link.symlink_to(real)
    task = task_in(folder)
    for place in (shared, link, tmp_path / "shared" / "x" / "\0"):
        cache = open_cache(place, "state")
        cache.put(task, result_of(task))
        assert cache.get(task) is None
    assert [*shared.iterdir(), *real.iterdir()] == []


def test_a_result_without_files_is_not_kept(folder, tmp_path):
    task, cache = task_in(folder), open_cache(tmp_path / "cache", "state")
    cache.put(task, TaskResult(interface=NodeInterface()))
    assert list((tmp_path / "cache").iterdir()) == []


def test_the_oldest_entries_go_when_there_are_too_many(tmp_path, monkeypatch):
    monkeypatch.setattr("rtron.sources.static.common.cache.MAX_BYTES", 25)
    for age, name in enumerate(("new", "middle", "old")):
        (tmp_path / name).write_bytes(b"x" * 10)
        os.utime(tmp_path / name, (1000 - age, 1000 - age))
    InterfaceCache(tmp_path, "state").trim()
    assert {path.name for path in tmp_path.iterdir()} == {"new", "middle"}


def test_the_state_is_the_structure_not_the_code(folder):
    def state():
        return hash_workspace(read_workspace([folder], {}))

    before = state()
    (folder / "robot/src/driver.cpp").write_text("int main() {}\n")
    assert state() == before
    (folder / "robot/scripts/run.sh").chmod(0o644)
    assert state() != before


def test_where_the_cache_lies():
    assert str(user_cache_folder({"XDG_CACHE_HOME": "/x"})) == "/x/rtron/scan"
    assert user_cache_folder({"XDG_CACHE_HOME": "relative"}) == user_cache_folder({})


def test_a_name_that_no_file_can_have_is_read_and_not_kept(folder, tmp_path):
    script = folder / "robot/scripts/teleop.py"
    script.write_text(script.read_text().replace('"cmd_vel"', '"\\ud800cmd_vel"'))
    for _ in range(2):
        graph = scan(folder, tmp_path / "cache").graph
        assert any("\ud800" in end.topic for end in graph.published_by("/teleop"))
