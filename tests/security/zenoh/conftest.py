"""A robot on Zenoh, and its driven base; only these need eclipse-zenoh."""

import pytest


@pytest.fixture
def robot(tmp_path):
    from zenoh_robot import ZenohRobot  # noqa: PLC0415 - the tests that use it skip without it

    with ZenohRobot(tmp_path) as robot:
        yield robot


@pytest.fixture
def driven(robot):
    from zenoh_robot import Driven  # noqa: PLC0415

    return Driven(robot)
