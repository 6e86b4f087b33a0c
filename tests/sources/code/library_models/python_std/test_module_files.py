"""Modules that a program loads by their files: what they define is followed, others are noted."""

import pytest

from rtron.sources.code.program_runner import run_python
from rtron.sources.code.workspace_sources import WorkspaceSources
from rtron.sources.declaration import NodeSite
from rtron.sources.workspace import Workspace

HELPER = """
import rospy
from std_msgs.msg import Bool
def make():
    rospy.Publisher("/x", Bool)
"""
LOADED = {
    "spec": "import importlib.util\n"
    "spec = importlib.util.spec_from_file_location('m', {path!r})\n"
    "m = importlib.util.module_from_spec(spec)\nspec.loader.exec_module(m)\nm.make()",
    "loader": "from importlib.machinery import SourceFileLoader\n"
    "SourceFileLoader('m', {path!r}).load_module().make()",
    "imp": "import imp\nimp.load_source('m', {path!r}).make()",
}


def run(folder, text):
    (folder / "script.py").write_text(text)
    files = WorkspaceSources(Workspace({"p": folder}, [folder]))
    return run_python(folder / "script.py", NodeSite(name="/n"), files)


@pytest.mark.parametrize("text", LOADED.values(), ids=LOADED)
def test_a_module_of_the_workspace_is_followed(tmp_path, text):
    path = tmp_path / "data" / "helper.py"
    path.parent.mkdir()
    path.write_text(HELPER)
    found = run(tmp_path, text.format(path=str(path)))
    assert [each.name for each in found.declarations] == ["/x"]
    assert found.unresolved == ()


@pytest.mark.parametrize("text", LOADED.values(), ids=LOADED)
def test_a_module_that_is_not_in_the_workspace_is_noted(tmp_path, text):
    notes = run(tmp_path, text.format(path="/no/such.py")).unresolved
    assert ("import of /no/such.py", "runs code that the source does not show") in {
        (each.what, each.why) for each in notes
    }


def test_a_module_that_loads_itself_by_another_name_of_its_folder_runs_once(tmp_path):
    path = "os.path.join(os.path.dirname(__file__), '../data/helper.py')"
    helper = tmp_path / "data" / "helper.py"
    helper.parent.mkdir()
    publisher = "rospy.Publisher('/x' + '_' * __file__.count('..'), Bool)"
    helper.write_text(f"import imp, os\n{HELPER}\n{publisher}\nimp.load_source('m', {path})\n")
    found = run(tmp_path, f"import imp\nimp.load_source('m', {str(helper)!r})")
    assert [each.name for each in found.declarations] == ["/x"]
