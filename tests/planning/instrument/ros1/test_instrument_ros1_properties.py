"""Any launch, guarded by any plan, is for ROS's own loader the same but for the plan's remaps."""

import tempfile
from pathlib import Path

import pytest
from file_tree import write
from guarded_launch import assert_guarded
from hypothesis import given, settings
from hypothesis import strategies as st
from launch_strategies import launches
from plans import grcn, plan_of

from example_budget import examples
from rtron.planning.instrument import instrument_ros1, write_guarded_launch
from rtron.planning.instrument.common.guarded_launch import GuardFiles
from rtron.sources.launch.ros1.reader import read_launch

TOPICS = ("/a", "/g/a", "/b")
COMMAND = ("sleep", "1000")


@st.composite
def plans(draw, nodes):
    some = st.lists(st.sampled_from([*nodes, "/absent"]), max_size=3, unique=True)
    topics = draw(st.lists(st.sampled_from(TOPICS), unique=True))
    return plan_of(*(grcn(topic, draw(some), draw(some)) for topic in topics))


@pytest.mark.ros1
@settings(max_examples=examples(200), deadline=None)
@given(files=launches(), data=st.data())
def test_any_guarded_launch_is_the_original_but_for_the_plans_remaps(ros, files, data):
    with tempfile.TemporaryDirectory() as folder:
        app = write(Path(folder), files) / "app.launch"
        tree = read_launch(app, {}, {}, {})
        plan = data.draw(plans([node.name for node in tree.nodes()]))
        out = Path(folder, "elsewhere", "guarded.launch")
        write_guarded_launch(instrument_ros1(tree, plan, out, GuardFiles("", command=COMMAND)))
        original, guarded = ros.load(app), ros.load(out)
    assert_guarded(original, guarded, plan, TOPICS)
