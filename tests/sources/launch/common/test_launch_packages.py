"""Where packages are found."""

import pytest

from rtron.errors import InputError
from rtron.sources.launch.common import packages
from rtron.sources.launch.common.packages import find_packages

MANIFEST = "<package><name> {} </name></package>"


def make(folder, name=None):
    folder.mkdir(parents=True)
    (folder / "package.xml").write_text(MANIFEST.format(name or folder.name))
    return folder


def own(folders, environ=None):
    """Return the packages found, but for those of the machine."""
    found = find_packages(folders, environ or {})
    return {name: path for name, path in found.items() if not str(path).startswith("/usr/share/")}


def test_packages_are_named_by_their_manifest(tmp_path):
    assert own([tmp_path]) == {}
    package = make(tmp_path / "src" / "folder", "name")
    assert own([tmp_path]) == {"name": package}


def test_packages_do_not_nest(tmp_path):
    outer = make(tmp_path / "outer")
    make(tmp_path / "outer" / "inner")
    assert own([tmp_path]) == {"outer": outer}


def test_the_package_that_is_given_may_hold_a_workspace(tmp_path):
    outer = make(tmp_path / "outer")
    inner = make(outer / "ws" / "inner")
    make(inner / "innermost")
    make(outer / "test" / "fixtures" / "sample")
    assert own([outer]) == {"outer": outer, "inner": inner}


def test_an_old_package_has_the_name_of_its_folder(tmp_path):
    (tmp_path / "old").mkdir()
    (tmp_path / "old" / "manifest.xml").write_text("<package/>")
    assert own([tmp_path]) == {"old": tmp_path / "old"}


def test_a_broken_manifest_names_by_the_folder(tmp_path):
    package = make(tmp_path / "broken")
    (package / "package.xml").write_text("<!DOCTYPE p><package><name>x</name></package>")
    assert own([tmp_path]) == {"broken": package}


MARKERS = ("AMENT_IGNORE", "CATKIN_IGNORE", "COLCON_IGNORE")


@pytest.mark.parametrize("marker", MARKERS)
def test_ignored_and_hidden_folders_are_not_searched(tmp_path, marker):
    for folder in ("ignored", "stop", ".hidden"):
        make(tmp_path / folder / "package")
    (tmp_path / "ignored" / marker).touch()
    (tmp_path / "stop" / "rospack_nosubdirs").touch()
    assert own([tmp_path]) == {}


@pytest.mark.parametrize("marker", MARKERS)
def test_an_ignored_package_is_none(tmp_path, marker):
    (make(tmp_path / "package") / marker).touch()
    assert own([tmp_path]) == {}


@pytest.mark.parametrize("marker", MARKERS)
def test_a_given_folder_that_is_ignored_is_an_error(tmp_path, marker):
    make(tmp_path / "package")
    (tmp_path / marker).touch()
    with pytest.raises(InputError, match=f"left out, as {marker} in it says"):
        own([tmp_path])
    assert own([], {"ROS_PACKAGE_PATH": str(tmp_path)}) == {}


def test_given_folders_come_before_the_package_path_and_the_first_wins(tmp_path):
    folders = [make(tmp_path / where / "p").parent for where in ("given", "one", "two")]
    path = f"{folders[1]}::{folders[2]}"
    assert own(folders[:1], {"ROS_PACKAGE_PATH": path})["p"] == folders[0] / "p"
    assert own([], {"ROS_PACKAGE_PATH": path})["p"] == folders[1] / "p"


def test_links_that_go_in_circles_end(tmp_path):
    package = make(tmp_path / "a" / "package")
    (tmp_path / "a" / "loop").symlink_to(tmp_path)
    assert own([tmp_path]) == {"package": package}


def test_a_deep_folder_is_left_out(tmp_path, deep_folder):
    deep_folder(tmp_path)
    package = make(tmp_path / "d" / "p")
    try:
        assert own([tmp_path]) == {"p": package}
    finally:
        (package / "package.xml").unlink()
        package.rmdir()


def test_a_folder_without_end_is_an_error(tmp_path, monkeypatch):
    monkeypatch.setattr(packages, "MAX_FOLDERS", 3)
    for name in "abcd":
        (tmp_path / name).mkdir()
    with pytest.raises(InputError, match="more than 3 folders"):
        own([tmp_path])


def test_a_linked_package_is_found(tmp_path):
    make(tmp_path / "elsewhere" / "package")
    (tmp_path / "src").mkdir()
    (tmp_path / "src" / "link").symlink_to(tmp_path / "elsewhere" / "package")
    assert own([tmp_path / "src"]) == {"package": tmp_path / "src" / "link"}
