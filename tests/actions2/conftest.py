"""What the tests of actions on ROS 2 share."""

from contextlib import ExitStack

import pytest


@pytest.fixture(scope="session")
def domains():
    """Keep each domain for one test: who has left another is still known there for a while."""
    with ExitStack() as stack:
        yield stack


@pytest.fixture
def app2(monkeypatch, domains):
    """Have a guarded action in a domain of the test's own."""
    pytest.importorskip("rclpy")
    from action_app2 import App2  # noqa: PLC0415 - needs rclpy
    from harness2 import own_domain  # noqa: PLC0415

    domain = domains.enter_context(own_domain())
    monkeypatch.setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
    monkeypatch.delenv("ROS_LOCALHOST_ONLY", raising=False)
    with ExitStack() as apps:

        def start(*policy, **settings):
            app = App2(domain, *policy, **settings)
            apps.callback(app.close)
            return app

        yield start
