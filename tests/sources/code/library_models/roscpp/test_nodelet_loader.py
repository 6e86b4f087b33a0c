"""A program that loads nodelets into itself with nodelet::Loader (ROS wiki: nodelet)."""

import pytest
from file_tree import write

from rtron.sources.code.program_runner import run_cpp, run_nodelet
from rtron.sources.code.workspace_sources import WorkspaceSources
from rtron.sources.declaration import NodeSite
from rtron.sources.launch.common.packages import find_packages
from rtron.sources.workspace import Workspace

FILES = {
    "package.xml": """<package><name>own</name>
<export><nodelet plugin="${prefix}/plugins.xml"/></export></package>""",
    "plugins.xml": """<library path="lib/libfilters"><class name="own/Filter" type="own::Filter"
 base_class_type="nodelet::Nodelet"/></library>""",
    "CMakeLists.txt": "add_library(filters filter.cpp)\nadd_executable(program main.cpp)\n",
    "filter.cpp": """#include <nodelet/nodelet.h>
namespace own { class Filter : public nodelet::Nodelet { void onInit() override {
  getNodeHandle().advertise<std_msgs::Bool>("shared", 1);
  getMTPrivateNodeHandle().advertise<std_msgs::Bool>("private", 1);
}; }; }
""",
    "main.cpp": """#include <nodelet/loader.h>
auto main(int argc, char** argv) -> int {
  ros::init(argc, argv, "program");
  BODY
}
""",
}


@pytest.fixture
def run(tmp_path):
    """Return what the program /robot/program declares and notes, by the body of its main."""
    write(tmp_path, FILES)
    workspace = Workspace(find_packages([tmp_path], {}), [tmp_path])

    def run(body):
        (tmp_path / "main.cpp").write_text(FILES["main.cpp"].replace("BODY", body))
        site = NodeSite(name="/robot/program")
        found = run_cpp((tmp_path / "main.cpp",), site, WorkspaceSources(workspace))
        names = [declared.name for declared in found.declarations if not declared.implicit]
        services = [declared.name for declared in found.declarations if declared.implicit]
        return names, services, [note.what for note in found.unresolved]

    return run


SERVICES = [f"/robot/program/{name}" for name in ("load_nodelet", "unload_nodelet", "list")]


def test_a_nodelet_of_the_nodes_own_name(run):
    body = """nodelet::Loader loader;
    loader.load(ros::this_node::getName(), "own/Filter", ros::names::getRemappings(), {});"""
    assert run(body) == (["/robot/shared", "/robot/program/private"], SERVICES, [])


def test_a_nodelet_of_another_name_and_a_loader_that_serves_nothing(run):
    body = """nodelet::Loader loader(false); nodelet::V_string args; nodelet::M_string remaps;
    loader.load("/front/filter", "own/Filter", remaps, args);"""
    assert run(body) == (["/front/shared", "/front/filter/private"], [], [])


def test_a_nodelet_that_is_not_here_is_noted(run):
    names, _, notes = run('nodelet::Loader loader; loader.load("a", "other/Filter", {}, {});')
    assert (names, notes) == ([], ["plugin other/Filter"])


def test_remaps_of_its_own_are_noted(run):
    body = """nodelet::Loader loader; std::map<std::string, std::string> remaps;
    remaps["shared"] = "other";
    loader.load("a", "own/Filter", remaps, {});"""
    assert "remaps in the program" in run(body)[2]


FILTER = """#include <nodelet/nodelet.h>
class Filter : public nodelet::Nodelet { void onInit() override {
  getNodeHandle().advertise<std_msgs::Bool>("given", 1);
  getPrivateNodeHandle().advertise<std_msgs::Bool>("given", 1);
  ros::NodeHandle made, own("~");
  made.advertise<std_msgs::Bool>("made", 1);
  own.advertise<std_msgs::Bool>(getName(), 1);
  own.advertise<std_msgs::Bool>("made", 1);
  made.advertise<std_msgs::Bool>(ros::this_node::getName() + "/process", 1);
} };
"""


def test_handles_of_the_nodelet_and_of_its_process(tmp_path):
    (tmp_path / "filter.cpp").write_text(FILTER)
    files = WorkspaceSources(Workspace({"p": tmp_path}, [tmp_path]))
    site = NodeSite(name="/front/filter", manager="/back/manager")
    found = run_nodelet((tmp_path / "filter.cpp",), "Filter", site, files)
    assert [declared.name for declared in found.declarations] == [
        *("/front/given", "/front/filter/given", "/back/made"),
        *("/front/filter", "/back/manager/made", "/back/manager/process"),
    ]
