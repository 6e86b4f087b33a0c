"""A guarded topic without a flow: its driver hears nobody."""

import pytest
from closed_topics import OUT, REFUSED, TOPIC, closed
from harness import wait_for

pytest.importorskip("rclpy", reason="needs ROS 2")
from rclpy_nodes import TWIST

from rtron.planning import write_plan

pytestmark = pytest.mark.ros2


def test_a_stranger_is_kept_out_where_the_plan_names_nobody_yet(ros2, stand):
    path = ros2.folder / "rtron.yaml"
    path.write_text(write_plan(closed(2, TWIST)))
    guard = ros2.rtron("guard", "--plan", path)
    wait_for(lambda: "guarding 1 topics" in guard.log or guard.ended, what="the guard")
    base, app = stand(), stand()
    heard = base.listener("/base", OUT)
    stranger = app.publisher("/stranger", TOPIC)
    said = []

    def is_refused_long():
        """Publish until fifty more were said after the refusal."""
        stranger.publish(b"\0\1\0\0" + bytes(48))
        said.append(REFUSED in guard.log)
        return sum(said) > 50

    base.wait_for(is_refused_long, "the refusal")
    assert heard == []
    assert not guard.ended, guard.log
