"""Our reading of any launch file against ROS's own loader."""

import tempfile
from pathlib import Path

import pytest
from file_tree import write
from hypothesis import given, settings
from hypothesis import strategies as st
from launch_strategies import BOOLEANS, VALUES, launches
from roslaunch_oracle import nodes_of_tree, started

from example_budget import examples
from rtron.sources.launch.ros1.reader import read_launch

ARGS = st.fixed_dictionaries(
    {}, optional={"flag": st.sampled_from(BOOLEANS[:4]), "x": st.sampled_from(VALUES)}
)


@pytest.mark.ros1
@settings(max_examples=examples(300), deadline=None)
@given(files=launches(), args=ARGS)
def test_any_launch_starts_the_nodes_that_ros_starts(ros, files, args):
    with tempfile.TemporaryDirectory() as folder:
        path = write(Path(folder), files) / "app.launch"
        dump = ros.load(path, args)
        tree = read_launch(path, args, {}, {})
    assert "error" not in dump, dump
    assert tree.unresolved == ()
    assert nodes_of_tree(tree) == started(dump)
