"""Definitions and MD5 sums of services of ROS 1."""

import pytest

from rtron.errors import SourceError
from rtron.messages import parse_definition
from rtron.messages.ros1.service_types import find_interface_text, service_md5sum

# The sums are those that rosservice shows (`rossrv md5`).
SUMS = [
    ("", "", "d41d8cd98f00b204e9800998ecf8427e"),
    ("bool data", "bool success\nstring message", "09fb03525b03e7ea1fd3992bafd87e16"),
    ("", "bool success\nstring message", "937c9679a518e3a18d831e57125ea522"),
    ("string logger\nstring level", "", "51da076440d78ca1684d36c868df61ea"),
]


@pytest.mark.parametrize(("request_text", "response_text", "md5sum"), SUMS)
def test_md5_sums(request_text, response_text, md5sum):
    request = parse_definition("a/BRequest", request_text)
    response = parse_definition("a/BResponse", response_text)
    assert service_md5sum(request, response) == md5sum


@pytest.fixture
def folder(tmp_path):
    for place in ("source/a", "install/share/a"):
        (tmp_path / place / "srv").mkdir(parents=True)
        (tmp_path / place / "srv" / "B.srv").write_text(f"# {place}\n---\n")
    return tmp_path


def test_sources_go_before_what_is_installed(folder):
    installed = {"CMAKE_PREFIX_PATH": f"{folder}/install"}
    assert find_interface_text("a/B", environ=installed) == "# install/share/a\n---\n"
    for path in (f"{folder}/source", f"/none:{folder}/source/a"):
        sourced = installed | {"ROS_PACKAGE_PATH": path}
        assert find_interface_text("a/B", environ=sourced) == "# source/a\n---\n"


@pytest.mark.parametrize("type", ["a/C", "../a/B", "a/../a/B", "a", "a/B/C", "", "a/B\n", "/a/B"])
def test_what_is_not_there_is_an_error(folder, type):
    with pytest.raises(SourceError):
        find_interface_text(type, environ={"ROS_PACKAGE_PATH": f"{folder}/source"})


def test_a_definition_that_is_too_long_is_an_error(folder):
    (folder / "source/a/srv/B.srv").write_text("#" * 70_000)
    with pytest.raises(SourceError, match="longer than"):
        find_interface_text("a/B", environ={"ROS_PACKAGE_PATH": f"{folder}/source"})
