"""Modules that a workspace makes of C++ for Python (pybind11)."""

import pytest
from file_tree import write
from ros2_runs import site

from rtron.sources.code.program_runner import run_python
from rtron.sources.code.workspace_sources import WorkspaceSources
from rtron.sources.static.ros2.app import read_ros2_workspace

CMAKE = "project(fast_drive)\npybind11_add_module(_drive src/drive.cpp)\n"


def notes(tmp_path, script, cpp):
    write(
        tmp_path / "fast_drive",
        {
            "package.xml": "<package><name>fast_drive</name></package>",
            "CMakeLists.txt": CMAKE,
            "src/drive.cpp": cpp,
            "script.py": script,
        },
    )
    files = WorkspaceSources(read_ros2_workspace([tmp_path]))
    found = run_python(tmp_path / "fast_drive" / "script.py", site(), files)
    return [(note.what, note.why, note.evidence[0].line) for note in found.unresolved]


@pytest.mark.parametrize("line", ["import _drive", "from fast_drive._drive import Drive"])
def test_an_extension_with_nodes_is_noted(tmp_path, line):
    why = "it is made of C++ (drive.cpp): the nodes in it are not followed"
    found = notes(tmp_path, f"{line}\n", "#include <rclcpp/rclcpp.hpp>\n")
    assert ("import of _drive", why, 1) in found


def test_an_extension_that_only_computes_is_not_noted(tmp_path):
    assert notes(tmp_path, "import _drive\n", "#include <vector>\n") == []
