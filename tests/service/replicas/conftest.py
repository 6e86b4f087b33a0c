"""Two replicas on a PostgreSQL database, a person at each, and tokens for guards.

What is of a module lasts as long as its tests; who kills replicas has `own_replicas`.
"""

import time
from contextlib import ExitStack, closing, contextmanager
from itertools import count
from types import SimpleNamespace

import httpx
import pytest
from replica_processes import LIMIT_S, Person, ReplicaProcess, SimulatedGuard, create_secret
from service_app import TLS, AccountFactory

from rtron.service.server.database_setup import add_first_admin
from rtron.service.store.database import Database

_numbers = count(1)


class Replicas(list):
    """Running replicas and their database."""

    def __init__(self, url, folder, *options):
        names = "first", "second"
        super().__init__(ReplicaProcess(folder, url, name, *options) for name in names)
        self.url, self.database = url, Database(url)
        scopes = "read", "admin", "developer", "end_user"
        self.secret = create_secret(self.database, "person", *scopes)

    def people(self):
        """Return a person at each replica."""
        return [Person(replica, self.secret) for replica in self]


@contextmanager
def running(url, folder, *options):
    """Run two replicas until the end of the block."""
    Database(url).close()
    replicas = Replicas(url, folder, *options)
    try:
        for each in replicas:
            each.wait_ready()
        yield replicas
    finally:
        for each in replicas:
            each.stop()
        replicas.database.close()


@pytest.fixture(scope="module")
def replicas(postgresql, tmp_path_factory):
    with running(postgresql.new_database(), tmp_path_factory.mktemp("replicas")) as started:
        yield started


@pytest.fixture
def own_replicas(postgresql, tmp_path):
    """Run replicas that have a user already: to add the first one takes them longest."""
    url = postgresql.new_database()
    with closing(Database(url)) as database:
        add_first_admin(database, time.time_ns())
    with running(url, tmp_path) as started:
        yield started


@pytest.fixture
def balanced_replicas(postgresql, tmp_path):
    """Run replicas that trust a balancer on this machine."""
    with running(postgresql.new_database(), tmp_path, "--proxy", "127.0.0.1") as started:
        yield started


@pytest.fixture
def people(replicas):
    asking = replicas.people()
    yield asking
    for each in asking:
        each.close()


@pytest.fixture
def car():
    """Give the name of a robot that no other test has."""
    return f"car{next(_numbers)}"


@pytest.fixture
def connect_guard():
    """Connect guards of robots, each with the token of its robot."""
    secrets, connected = {}, []

    def connect(replicas, index, robot, **values):
        key = replicas.url, robot
        if key not in secrets:
            secrets[key] = create_secret(replicas.database, robot, "guard", robot=robot)
        connected.append(SimulatedGuard(replicas[index], robot, secrets[key], **values))
        return connected[-1]

    yield connect
    for guard in connected:
        guard.close()


@pytest.fixture
def guard(replicas, car, guard_class):
    """A guard of the test's own class at the first replica."""
    secret = create_secret(replicas.database, car, "guard", robot=car)
    made = guard_class(replicas[0].port, {"Authorization": f"Bearer {secret}"})
    yield made
    made.close()


@pytest.fixture
def ann(replicas):
    """A person's browser at each replica."""
    parts = SimpleNamespace(database=replicas.database, clock=time.time_ns)
    headers = AccountFactory(parts).session_headers("ann", "end_user")
    with ExitStack() as stack:
        yield [
            stack.enter_context(
                httpx.Client(
                    base_url=f"{each.url}/api/v1", headers=headers, timeout=LIMIT_S, verify=TLS
                )
            )
            for each in replicas
        ]
