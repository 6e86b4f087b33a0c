"""Guards of the robot r1 at the service, and a person."""

import pytest
from harness import wait_for


@pytest.fixture
def connect(app, port, people, guard_class):
    """Connect a guard of the test's own class, and wait until the service has its state."""
    guards = []

    def connect(*values, **hello):
        headers = people.token_headers("r1", "guard", robot="r1")
        guards.append(guard_class(port, headers, *values, **hello))
        wait_for(lambda: app.state.service.hub.state("r1"), what="the guard's state")
        return guards[-1]

    yield connect
    for guard in guards:
        guard.close()


@pytest.fixture
def guard(connect):
    return connect()


@pytest.fixture
def ann(people):
    return people.session_headers("ann", "end_user")
