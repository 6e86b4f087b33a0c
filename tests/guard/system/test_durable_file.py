"""Files that a crash leaves whole."""

import os
import stat

from rtron.guard.system.durable_file import remove_file, replace_file


def test_a_file_is_replaced_and_only_its_owner_s(tmp_path):
    path = tmp_path / "state.json"
    replace_file(path, b"old")
    replace_file(path, b"new")
    assert path.read_bytes() == b"new"
    assert stat.S_IMODE(path.stat().st_mode) == 0o600
    assert [each.name for each in tmp_path.iterdir()] == ["state.json"]


def test_what_is_written_is_on_the_disk_before_the_name_is(tmp_path, monkeypatch):
    done = []
    monkeypatch.setattr(os, "fsync", lambda descriptor: done.append(os.fstat(descriptor).st_ino))
    path = tmp_path / "state.json"
    replace_file(path, b"new")
    assert done == [path.stat().st_ino, tmp_path.stat().st_ino]
    remove_file(path)
    remove_file(path)
    assert done[2:] == [tmp_path.stat().st_ino]
