"""A disk that is really full refuses events, not connections, and no stop; nothing is forgotten."""

from contextlib import closing
from itertools import takewhile

import pytest
from full_disks import LimitedFiles, LimitedServer, SmallFileSystem, can_mount, closing_disk
from harness import wait_for
from postgresql_server import PostgreSQL, programs
from replica_processes import Person, SimulatedGuard, create_secret
from sqlalchemy import text
from store_data import make_verdict, new_robot, store_events

from rtron.service.store.database import Database
from rtron.vocabulary import GuardEvent
from rtron.wire.common.link_protocol import Events, EventsRefused, Stored

BATCH, MOST_BATCHES = 200, 100
ROBOTS = "car", "truck"


def secrets(database):
    """Make a token for a person and for the guard of each robot."""
    scopes = "read", "admin", "developer", "end_user"
    made = {name: create_secret(database, name, "guard", robot=name) for name in ROBOTS}
    return {"person": create_secret(database, "person", *scopes), **made}


@pytest.fixture(params=["limited files", "small file system"])
def sqlite_disk(request, tmp_path):
    if request.param == "small file system" and not can_mount(tmp_path):
        pytest.skip("this user may not mount a file system, even in a namespace of their own")
    seed = tmp_path / "copied"
    seed.mkdir()
    with closing(Database(seed / "rtron.db")) as database:
        tokens = secrets(database)
    kind = LimitedFiles if request.param == "limited files" else SmallFileSystem
    with closing_disk(kind(tmp_path, seed)) as disk:
        disk.tokens = tokens
        yield disk


@pytest.fixture(scope="module")
def own_server():
    """Run a PostgreSQL server whose files may be limited, but for those of its log (1 MB)."""
    if programs() is None:
        pytest.skip("Debian's postgresql is not installed: make setup")
    server = PostgreSQL("--wal-segsize=1")
    yield server
    server.stop()


@pytest.fixture
def postgresql_disk(own_server, tmp_path):
    url = own_server.new_database()
    with closing(Database(url)) as database:
        tokens = secrets(database)
        other = new_robot(database, "other")
        events = [make_verdict(number, reason="x" * 900) for number in range(1, 1501)]
        store_events(database, other, events, robot="other")

        def table_bytes():
            with database.session() as session:
                return session.scalar(text("SELECT pg_relation_size('events_p0')"))

        assert table_bytes() > 1 << 20
        with closing_disk(LimitedServer(tmp_path, own_server, url, table_bytes)) as disk:
            disk.tokens = tokens
            yield disk


class Robot:
    """A guard with a spool of events: what is not acknowledged comes again."""

    def __init__(self, disk, name):
        self.guard = SimulatedGuard(
            disk.service, name, disk.tokens[name], takes_refusals=True, takes_audit_heads=False
        )
        self.sent = self.acknowledged = 0

    def send(self):
        """Send a batch behind what is acknowledged; tell whether it is stored."""
        numbers = range(self.acknowledged + 1, self.acknowledged + 1 + BATCH)
        self.sent = max(self.sent, numbers[-1])
        self.guard.send(Events(events=tuple(map(_event, numbers))))
        while isinstance(answer := self.guard.receive((Stored, EventsRefused)), Stored):
            self.acknowledged = answer.number
            if self.acknowledged == numbers[-1]:
                return True
        return False


def _event(number):
    made = make_verdict(number, reason=f"event {number} " + "x" * 900)
    assert isinstance(made, GuardEvent)
    return made


def stored_numbers(person):
    numbers, query = [], "limit=1000&robot=car&kind=verdict"
    page = person.ask(f"/events?{query}").json()
    while True:
        numbers += [int(event["reason"].split()[1]) for event in page["events"]]
        if page["next"] is None:
            return sorted(numbers)
        page = person.ask(f"/events?{query}&before={page['next']}").json()


def _check(disk):
    person = Person(disk.service, disk.tokens["person"])
    with closing(person):
        car = Robot(disk, "car")
        assert car.send()
        disk.fill()
        taken = sum(takewhile(bool, (car.send() for _ in range(MOST_BATCHES))))
        assert taken < MOST_BATCHES, "the disk takes everything"
        car.guard.tell_state(fps={"eyes": 12.5})
        wait_for(lambda: (person.robot("car")["state"] or {}).get("fps") == {"eyes": 12.5})
        assert stored_numbers(person) == list(range(1, car.acknowledged + 1))
        answer = person.stop("car", "smoke")
        assert answer.status_code == 200 or "the stop is sent, but not stored" in answer.text
        assert car.guard.receive_settings().stop.reason == "smoke"
        assert Robot(disk, "truck").guard.settings.stop is None
        assert not car.send()
        disk.free()
        wait_for(car.send, what="the events after the disk is free again")
        assert stored_numbers(person) == list(range(1, car.acknowledged + 1))
        person.stop("car", "smoke")
        assert person.robot("car")["stop"]["reason"] == "smoke"
        car.guard.close()


def test_a_full_disk_of_sqlite(sqlite_disk):
    _check(sqlite_disk)


def test_a_full_disk_of_postgresql(postgresql_disk):
    _check(postgresql_disk)
