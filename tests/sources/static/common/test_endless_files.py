"""What never ends in a folder of packages: a pipe, a device, a file larger than any source."""

import os
import subprocess
import sys

import pytest
from file_tree import write

from rtron.errors import InputError
from rtron.sources.bounded_file import content_hash, read_regular_file

LAUNCH = '<launch><node pkg="p" exec="talker" name="talker"/></launch>'
MANIFEST = """<package format="3"><name>p</name>
<export><build_type>ament_cmake</build_type></export></package>"""
NAMES = (
    "x.cmake",
    "x.xml",
    "setup.cfg",
    "src/talker.cpp",
    "include/p/x.hpp",
    "msg/X.msg",
    "x.yaml",
)
LIMIT = 60


def package(folder):
    write(
        folder / "p",
        {
            "package.xml": MANIFEST,
            "a.launch.xml": LAUNCH,
            "CMakeLists.txt": "include(x.cmake)\nadd_executable(talker src/talker.cpp)\n",
            "src/main.cpp": '#include "p/x.hpp"\n',
        },
    )
    return folder / "p"


def pipe(path):
    os.mkfifo(path)


def device(path):
    path.symlink_to("/dev/zero")


def scanned(folder):
    command = [sys.executable, "-m", "rtron", "scan", folder, "--launch", "p/a.launch.xml"]
    environ = {**os.environ, "XDG_CACHE_HOME": str(folder / "cache")}
    return subprocess.run(
        command, env=environ, capture_output=True, text=True, timeout=LIMIT, check=False
    )


@pytest.mark.parametrize("endless", [pipe, device])
def test_a_scan_with_what_never_ends_in_it_comes_to_its_end(tmp_path, endless):
    own = package(tmp_path)
    for name in NAMES:
        (own / name).parent.mkdir(parents=True, exist_ok=True)
        endless(own / name)
    done = scanned(tmp_path)
    assert done.returncode in (0, 1), done.stderr
    assert "/talker" in done.stdout
    assert "Traceback" not in done.stderr


@pytest.mark.parametrize("endless", [pipe, device])
def test_what_never_ends_is_not_read(tmp_path, endless):
    path = tmp_path / "x"
    endless(path)
    assert content_hash(path) == ""
    with pytest.raises(InputError, match="is a pipe or a device"):
        read_regular_file(path, 10)


def test_the_hash_of_a_file_tells_its_length_past_what_is_read(tmp_path):
    one, two = tmp_path / "one", tmp_path / "two"
    for path, size in ((one, 2**40), (two, 2**40 + 1)):
        with path.open("wb") as stream:
            stream.truncate(size)
    assert content_hash(one) != content_hash(two)
