"""Files that a crash leaves whole."""

import os
import stat

from rtron.guard.incidents.incident_folder import IncidentFolder
from rtron.guard.system.durable_file import make_private_folder, remove_file, replace_file


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


def test_folders_that_are_made_are_for_this_user_alone(tmp_path):
    """One above that others may enter would not be trusted with what is stopped."""
    there = tmp_path / "there"
    there.mkdir(mode=0o755)
    make_private_folder(there / "app" / "incidents" / "ring")
    made = [there / "app", there / "app" / "incidents", there / "app" / "incidents" / "ring"]
    assert [each.stat().st_mode & 0o777 for each in made] == [0o700] * 3
    assert there.stat().st_mode & 0o777 == 0o755
    make_private_folder(made[-1])


def test_the_folder_of_an_app_stays_private_whoever_makes_it_first(tmp_path):
    IncidentFolder(tmp_path / "app" / "incidents", 1000)
    assert (tmp_path / "app").stat().st_mode & 0o777 == 0o700
