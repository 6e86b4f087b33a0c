"""The place of the bulk process: one process has it, and nobody of another user can."""

import socket
import subprocess
import sys
from contextlib import closing
from uuid import uuid4

import pytest

from rtron.errors import SourceError
from rtron.guard.lanes.exchange.bulk_socket import BulkSocket
from rtron.guard.system.unix_socket import runtime_folder

LISTEN = """
import sys
from rtron.guard.lanes.exchange.bulk_socket import BulkSocket
place = BulkSocket(sys.argv[1])
sock = place.listen()
print("listens", flush=True)
sys.stdin.read()
"""


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    tmp_path.chmod(0o700)
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path))
    return tmp_path


@pytest.fixture
def configuration():
    return uuid4().hex


@pytest.fixture
def place(configuration):
    with closing(BulkSocket(configuration)) as place:
        yield place


@pytest.fixture
def other(configuration):
    """Let another process listen."""
    command = [sys.executable, "-c", LISTEN, configuration]
    pipe = subprocess.PIPE
    with subprocess.Popen(command, stdin=pipe, stdout=pipe, text=True) as process:
        assert process.stdout.readline() == "listens\n"
        yield process
        process.kill()


def connects(place):
    with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as sock:
        return place.connect(sock)


def test_nobody_listens_at_first(place):
    assert not connects(place)


def test_one_process_has_the_place_and_is_found(place, other):
    assert connects(place)
    with pytest.raises(SourceError, match="has a bulk process already"):
        place.listen()


def test_the_place_is_free_when_its_process_was_killed(place, other):
    other.kill()
    other.wait()
    assert not connects(place)
    with place.listen():
        assert connects(place)


def test_another_plan_has_another_place(other):
    with closing(BulkSocket(uuid4().hex)) as place:
        assert not connects(place)


def test_a_folder_that_others_may_enter_is_refused(folder, configuration):
    folder.chmod(0o711)
    with pytest.raises(SourceError, match="others may enter") as error:
        BulkSocket(configuration)
    assert "XDG_RUNTIME_DIR" in error.value.help


def test_a_long_path_is_no_hindrance(tmp_path, monkeypatch, configuration):
    deep = tmp_path.joinpath(*["a" * 50] * 3)
    deep.mkdir(parents=True, mode=0o700)
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(deep))
    assert runtime_folder() == deep
    with closing(BulkSocket(configuration)) as place, place.listen():
        assert connects(place)


def test_who_lets_go_twice_leaves_the_place_to_the_next(place, configuration):
    place.listen().close()
    place.close()
    place.close()
    with closing(BulkSocket(configuration)) as following, following.listen():
        assert connects(following)
