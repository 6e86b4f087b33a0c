"""What the tests of actions on ROS 2 share."""

from contextlib import ExitStack

import pytest


@pytest.fixture(scope="session")
def domains():
    """Keep each domain for one test: who has left another is still known there for a while."""
    with ExitStack() as stack:
        yield stack


@pytest.fixture
def start_action_app(monkeypatch, domains):
    """Have a guarded action in a domain of the test's own."""
    pytest.importorskip("rclpy", reason="needs ROS 2")
    from ros2_action_app import RclpyActionApp  # noqa: PLC0415 - needs rclpy
    from ros2_harness import reserve_domain  # noqa: PLC0415

    monkeypatch.setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
    monkeypatch.delenv("ROS_LOCALHOST_ONLY", raising=False)
    with ExitStack() as apps:

        def start(*policy, kind=RclpyActionApp, **settings):
            app = kind(domains.enter_context(reserve_domain()), *policy, **settings)
            apps.callback(app.close)
            return app

        yield start
