"""Folders are walked as os.walk does, however deep they are."""

import os

import pytest

from rtron.errors import InputError
from rtron.folders import MAX_DEPTH, is_folder, path_exists, walk

LONG = "n" * 5000


@pytest.fixture
def tree(tmp_path):
    for name in ("b/x", "a/y/z", "a/w"):
        (tmp_path / name).mkdir(parents=True)
    for name in ("file", "b/one", "a/y/two"):
        (tmp_path / name).touch()
    (tmp_path / "b/up").symlink_to("../a")
    (tmp_path / "b/nowhere").symlink_to("absent")
    return tmp_path


@pytest.fixture
def unread():
    return []


def listed(walked):
    return [(folder, sorted(below), sorted(files)) for folder, below, files in sort(walked)]


def sort(walked):
    for found in walked:
        found[1].sort()
        yield found


@pytest.mark.parametrize("links", [False, True])
def test_it_goes_as_os_walk_does(tree, links):
    assert listed(walk(tree, follow_links=links)) == listed(os.walk(tree, followlinks=links))


def test_what_is_taken_out_is_not_entered(tree):
    entered = []
    for folder, below, _ in walk(tree):
        below[:] = [name for name in below if name != "a"]
        entered.append(folder)
    assert entered[0] == str(tree)
    assert not any("/a" in folder.removeprefix(str(tree)) for folder in entered)


def test_what_lies_too_deep_is_told(tmp_path, unread, deep_folder):
    deep_folder(tmp_path)
    found = [folder for folder, _, _ in walk(tmp_path, lambda *told: unread.append(told))]
    assert len(found) == MAX_DEPTH + 1
    assert unread == [(f"{found[-1]}/d", "lies more than 100 folders deep")]
    assert len(list(walk(tmp_path))) == MAX_DEPTH + 1


@pytest.mark.parametrize(
    ("name", "why"),
    [
        ("absent", "No such file or directory"),
        ("file", "Not a directory"),
        (LONG, "File name too long"),
    ],
)
def test_what_cannot_be_listed_is_told(tree, unread, name, why):
    assert list(walk(tree / name, lambda *told: unread.append(told))) == []
    assert unread == [(str(tree / name), why)]


def test_a_path_that_no_file_can_have(tree):
    assert is_folder(tree)
    assert not is_folder(tree / "file")
    assert not is_folder(tree / "absent")
    with pytest.raises(InputError, match="File name too long") as raised:
        is_folder(tree / LONG)
    assert raised.value.path == str(tree / LONG)
    assert [path_exists(tree / name) for name in ("file", "absent", LONG)] == [True, False, False]
