"""The names of a nodelet are its own, those of handles that it makes are its manager's."""

from rtron.sources.code.program_runner import run_nodelet
from rtron.sources.code.workspace_sources import WorkspaceSources
from rtron.sources.declaration import NodeSite
from rtron.sources.workspace import Workspace

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
