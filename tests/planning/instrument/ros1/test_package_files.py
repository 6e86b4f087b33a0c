"""The scripts that nodes run, however deep their packages are."""

from rtron.planning.instrument.ros1.runtime_launch import find_scripts
from rtron.vocabulary import LaunchNode


def test_a_deep_folder_in_a_package_hides_no_other(tmp_path, deep_folder):
    deep_folder(tmp_path)
    script = tmp_path / "scripts/run"
    script.parent.mkdir()
    script.write_text("#!/bin/sh\n")
    (tmp_path / "package.xml").write_text("<package><name>p</name></package>")
    node = LaunchNode(name="/n", package="p", type="run", element_index=1)
    (found,) = find_scripts([node], {"p": tmp_path})
    assert found.path == script
