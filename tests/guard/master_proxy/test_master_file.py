"""How the guard finds the master behind the proxy: never by another's word, nor a dead proxy's."""

import json
import os

import pytest

from rtron.errors import SourceError
from rtron.guard.master_proxy.master_file import MasterFile, candidate_paths, find_private_master

PORT = 11399
PUBLIC = f"http://localhost:{PORT}"
PRIVATE = "http://127.0.0.1:40001/"


@pytest.fixture(autouse=True)
def runtime(tmp_path, monkeypatch):
    folder = tmp_path / "runtime"
    folder.mkdir(mode=0o700)
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(folder))
    return folder


@pytest.fixture
def announced():
    announcement = MasterFile(PORT, PRIVATE)
    yield announcement
    announcement.close()


@pytest.mark.parametrize("host", ["localhost", "127.0.0.1"])
def test_the_guard_finds_the_master_behind_the_proxy(announced, host):
    assert find_private_master(f"http://{host}:{PORT}/") == PRIVATE


def test_a_guard_with_another_runtime_folder_finds_it_too(announced, monkeypatch, tmp_path):
    folders = [path.parent for path in candidate_paths(PORT)]
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path))
    assert [path.parent for path in candidate_paths(PORT)][1:] == folders[1:]
    assert find_private_master(PUBLIC) == PUBLIC
    monkeypatch.delenv("XDG_RUNTIME_DIR")
    second = MasterFile(PORT, "http://127.0.0.1:40002/")
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path))
    assert find_private_master(PUBLIC) == "http://127.0.0.1:40002/"
    second.close()


@pytest.mark.parametrize(
    "uri",
    ["http://localhost:11398", f"http://192.0.2.1:{PORT}", "http://localhost", "nonsense", ""],
)
def test_any_other_address_stays(announced, uri):
    assert find_private_master(uri) == uri


def test_only_its_user_can_read_it(announced):
    assert candidate_paths(PORT)[0].stat().st_mode & 0o777 == 0o600


def test_it_goes_with_the_proxy():
    for _ in range(2):
        announcement = MasterFile(PORT, PRIVATE)
        assert find_private_master(PUBLIC) == PRIVATE
        announcement.close()
        assert not candidate_paths(PORT)[0].exists()
        assert find_private_master(PUBLIC) == PUBLIC


def test_what_a_dead_proxy_left_is_not_believed_and_makes_room():
    candidate_paths(PORT)[0].write_text(json.dumps({"private": "http://127.0.0.1:40002/"}))
    candidate_paths(PORT)[0].chmod(0o600)
    assert find_private_master(PUBLIC) == PUBLIC
    announcement = MasterFile(PORT, PRIVATE)
    assert find_private_master(PUBLIC) == PRIVATE
    announcement.close()


@pytest.mark.parametrize("mode", [0o644, 0o620, 0o604])
def test_a_file_that_others_may_read_is_not_believed(announced, mode):
    candidate_paths(PORT)[0].chmod(mode)
    assert find_private_master(PUBLIC) == PUBLIC


def test_a_folder_that_others_may_enter_is_not_believed(announced, runtime):
    runtime.chmod(0o755)
    assert find_private_master(PUBLIC) == PUBLIC
    with pytest.raises(SourceError, match="others may enter"):
        MasterFile(PORT, PRIVATE)
    runtime.chmod(0o700)


def test_a_link_is_not_followed(announced, tmp_path):
    candidate_paths(PORT)[0].rename(tmp_path / "elsewhere")
    candidate_paths(PORT)[0].symlink_to(tmp_path / "elsewhere")
    assert find_private_master(PUBLIC) == PUBLIC


@pytest.mark.parametrize("text", ["", "[]", "{}", '{"private": 7}', '{"private": "x"}', "\x00"])
def test_a_file_that_says_nothing_of_use_is_not_believed(announced, text):
    os.truncate(announced._descriptor, 0)
    os.pwrite(announced._descriptor, text.encode(), 0)
    assert find_private_master(PUBLIC) == PUBLIC


def test_a_pipe_does_not_hold_the_guard_up(runtime):
    os.mkfifo(candidate_paths(PORT)[0], 0o600)
    assert find_private_master(PUBLIC) == PUBLIC


def test_what_another_proxy_put_there_stays():
    announcement = MasterFile(PORT, PRIVATE)
    candidate_paths(PORT)[0].unlink()
    candidate_paths(PORT)[0].write_text("another's")
    announcement.close()
    assert candidate_paths(PORT)[0].read_text() == "another's"
