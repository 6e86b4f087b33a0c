"""Pictures of megabytes through the guard on ROS 1, and commands beside them that must not wait."""

import pytest
from bulk_load import MOST_DELAY, commands_beside_pictures

pytestmark = pytest.mark.ros1


def test_commands_do_not_wait_for_pictures(ros1):
    """Long: pictures of megabytes take both cores while the base hears 300 commands."""
    heard, longest_gap = commands_beside_pictures(ros1.environ, ros1.folder, ros=1)
    assert longest_gap <= MOST_DELAY
    assert heard.unguarded() == []
