"""An emergency stop of many robots at once, on real databases."""

from contextlib import contextmanager
from dataclasses import replace
from threading import Thread

import pytest
from controller_setup import DEVELOPER, END_USER, ControllerSetup, caller, hello, plan
from failing_database import read_only
from sqlalchemy import select

from rtron.errors import SourceError
from rtron.service.controller.fleet_stop import FleetStop
from rtron.service.controller.robot_snapshot import load_snapshot
from rtron.service.domain.errors import ForbiddenError, NotFoundError
from rtron.service.domain.principal import UserRole
from rtron.service.domain.schemas import SettingsChange
from rtron.service.store.chain_check import check_database
from rtron.service.store.database import Database
from rtron.service.store.fleet.labels import replace_labels
from rtron.service.store.robots import find_robot, register_robot
from rtron.service.store.settings import list_settings, settings_view
from rtron.service.store.tables import AuditRow
from rtron.wire.common.link_protocol import Applied

NAMES = [f"r{number}" for number in range(20)]
CHANGE = {"revision": 0, "nodes": {"drive": {"policy": "Block"}}, "reason": "why"}


@pytest.fixture
def world(database):
    """Controller and database of either kind; the guards of 20 robots have said hello."""
    made = ControllerSetup(database)
    for name in NAMES:
        made.controller.handle_hello(name, hello(plan()))
    return made


def stop(world, robots=NAMES, who=END_USER, reason="fire"):
    return world.controller.start_emergency_stops(
        FleetStop(caller=who, robots=robots, reason=reason)
    )


def newest(world, robot):
    with world.database.session() as session:
        return settings_view(load_snapshot(session, robot).row)


def stop_lines(world):
    with world.database.session() as session:
        query = select(AuditRow).where(AuditRow.action == "stop").order_by(AuditRow.id)
        return [(row.target, row.outcome) for row in session.scalars(query)]


def test_each_robot_gets_a_stop_of_its_own(world):
    world.controller.change(DEVELOPER, "r3", SettingsChange(**CHANGE))
    assert stop(world) == {}
    views = {name: newest(world, name) for name in NAMES}
    assert {name: view.settings for name, view in views.items()} == dict(world.guards.pushed[1:])
    assert {view.settings.stop.reason for view in views.values()} == {"fire"}
    assert [views[name].revision for name in ("r2", "r3")] == [1, 2]
    assert views["r3"].settings.nodes["drive"].policy == "Block"
    assert sorted(stop_lines(world)) == sorted((name, "done") for name in NAMES)
    assert [message["robot"] for message in world.guards.messages[-20:]] == [
        name for name, _ in world.guards.pushed[1:]
    ]
    with world.database.session() as session:
        assert check_database(session, {}, ()).is_whole


class Counted(Database):
    """Counts transactions that wait for the disk."""

    durable = 0

    @contextmanager
    def write_session(self, *, durable=False, urgent=False):
        with super().write_session(durable=durable, urgent=urgent) as session:
            yield session
        self.durable += durable


def test_the_disk_is_waited_for_once(tmp_path):
    world = ControllerSetup(Counted(tmp_path / "rtron.db"))
    for name in NAMES:
        world.controller.handle_hello(name, hello(plan()))
    before = world.database.durable
    assert stop(world) == {}
    assert world.database.durable == before + 1
    world.database.close()


def test_what_is_known_of_each_is_told(world):
    with world.database.session() as session:
        register_robot(session, "silent", 1)
    failures = stop(world, ["r0", "silent", "nobody"])
    assert {robot: (type(error), str(error)) for robot, error in failures.items()} == {
        "silent": (NotFoundError, "no guard of silent has said hello yet"),
        "nobody": (NotFoundError, "there is no such robot"),
    }
    assert [robot for robot, _ in world.guards.pushed] == ["r0"]
    assert ("nobody", "refused: there is no such robot") in stop_lines(world)


def test_the_same_stop_in_force_makes_no_revision_anothers_does(world):
    stop(world)
    for name in NAMES[:10]:
        world.controller.handle_applied(name, Applied(revision=1))
    assert stop(world) == {}
    assert [newest(world, name).revision for name in ("r0", "r10")] == [1, 2]
    assert stop(world, who=DEVELOPER) == {}
    assert newest(world, "r0").settings.stop.by == "dev"


def test_a_stop_does_not_take_along_what_a_guard_refused(world):
    world.controller.change(DEVELOPER, "r3", SettingsChange(**CHANGE))
    world.controller.handle_applied("r3", Applied(revision=1, error="no"))
    assert stop(world) == {}
    assert newest(world, "r3").settings.nodes == {}
    assert newest(world, "r3").settings.stop.reason == "fire"


def test_who_is_limited_to_groups_stops_their_robots_alone(world):
    with world.database.session() as session:
        for name in NAMES[:2]:
            replace_labels(session, find_robot(session, name)[0], ["hall-a"])
    tom = replace(caller(UserRole.END_USER, name="tom"), groups=frozenset({"hall-a"}))
    failures = stop(world, ["r0", "r1", "r2", "nobody"], who=tom)
    assert {robot: str(error) for robot, error in failures.items()} == {
        name: f"{name} is in no group of tom" for name in ("r2", "nobody")
    }
    assert [robot for robot, _ in world.guards.pushed] == ["r0", "r1"]
    assert ("r2", "refused: r2 is in no group of tom") in stop_lines(world)


def test_without_a_role_nobody_is_stopped(world):
    with pytest.raises(ForbiddenError):
        stop(world, who=caller())
    assert world.guards.pushed == []


def test_stops_go_out_even_if_they_cannot_be_stored(tmp_path):
    world = ControllerSetup(Database(tmp_path / "rtron.db"))
    for name in NAMES:
        world.controller.handle_hello(name, hello(plan()))
    with read_only(world.database):
        failures = stop(world)
        assert {type(error) for error in failures.values()} == {SourceError}
        assert all("is sent, but not stored" in str(error) for error in failures.values())
        assert {name for name, sent in world.guards.pushed if sent.stop} == set(NAMES)
        stop(world, NAMES[:1], reason="flood")
    assert stop(world, reason="smoke") == {}
    with world.database.session() as session:
        app = load_snapshot(session, "r0").app
        rows = list_settings(session, app.id, None, 9)
        assert [row.reason for row in rows] == ["smoke", "flood", "the plan"]
    assert world.guards.pushed[-1][1].stop.reason == "smoke"
    world.database.close()


def test_stops_of_many_and_of_one_at_once_lose_none(world):
    others = [
        Thread(target=world.controller.start_emergency_stop, args=(DEVELOPER, name, "alone"))
        for name in NAMES[:4]
    ]
    many = [Thread(target=stop, args=(world, NAMES[::step])) for step in (1, -1)]
    for thread in [*others, *many]:
        thread.start()
    for thread in [*others, *many]:
        thread.join()
    assert [newest(world, name).revision for name in ("r0", "r10")] == [3, 2]
    for name in NAMES:
        last = [sent for robot, sent in world.guards.pushed if robot == name][-1]
        assert last == newest(world, name).settings
