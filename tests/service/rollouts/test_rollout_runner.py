"""Roll-outs on real databases: stages, limits, what goes back, restarts, rights."""

import pytest
from controller_setup import END_USER, caller
from rollout_setup import ANN, NODES
from sqlalchemy import select

from rtron.errors import InputError
from rtron.service.controller.robot_snapshot import load_snapshot
from rtron.service.domain.errors import ConflictError, ForbiddenError, NotFoundError
from rtron.service.domain.principal import Principal, UserRole
from rtron.service.domain.rollouts.schemas import Problem, RobotSelection
from rtron.service.domain.schemas import SettingsChange
from rtron.service.store.accounts.users import get_user, set_groups
from rtron.service.store.chain_check import all_chains, check_database, snapshot
from rtron.service.store.settings import list_settings, settings_view
from rtron.service.store.tables import AuditRow
from rtron.vocabulary import Alarm, AlarmKind, EventKind, GuardState, PolicyName

BAD = GuardState(at=0, revision=0, alarms=(Alarm(kind=AlarmKind.DRIFT, reason="why"),))


@pytest.fixture
def site(sqlite_cars):
    return sqlite_cars


def policy(cars, robot):
    with cars.world.database.session() as session:
        snapshot = load_snapshot(session, robot)
        node = snapshot.settings.nodes.get("drive")
        return node.policy if node else None


def history(cars, robot):
    with cars.world.database.session() as session:
        app = load_snapshot(session, robot).app
        return [settings_view(row) for row in list_settings(session, app.id, None, 100)]


def test_a_good_change_reaches_all_in_stages(cars):
    id = cars.start(stages=[1, "30%", "100%"])
    reached = []
    for seconds in (0, 59, 1, 59, 1, 59, 1):
        cars.run(seconds)
        reached.append(len(cars.reached(id)))
    assert reached == [1, 1, 3, 3, 10, 10, 10]
    view = cars.view(id)
    assert (view.state, view.applied, view.targets) == ("done", 10, [1, 3, 10])
    assert {policy(cars, robot) for robot in cars.robots} == {PolicyName.BLOCK}


def test_each_change_is_an_ordinary_revision(cars):
    id = cars.start()
    cars.run()
    (canary,) = cars.reached(id)
    view = history(cars, canary)[0]
    assert (view.revision, view.by, view.outcome) == (1, "ann", "applied")
    assert view.reason == f"roll-out {id}: visitors"
    with cars.world.database.session() as session:
        lines = session.scalars(select(AuditRow).where(AuditRow.action == "settings")).all()
    assert ("ann", canary, "done") in [(each.who, each.target, each.outcome) for each in lines]


def test_a_bad_change_goes_back_from_the_canary(cars):
    id = cars.start()
    cars.run()
    (canary,) = cars.reached(id)
    cars.fleet.states[canary] = BAD
    cars.run(1)
    view = cars.view(id)
    assert (view.state, view.sent, view.reverted, view.waiting) == ("reverted", 0, 1, 9)
    assert view.note == f"alarm: 1 of 1 robots, at most 0: {canary}"
    assert view.problems == {Problem.ALARM: 1}
    assert policy(cars, canary) is None
    assert history(cars, canary)[0].by == "rtron"
    with cars.world.database.session() as session:
        assert check_database(session, {}, ()).faults == []
    cars.run(10_000, steps=3)
    assert cars.view(id).state == "reverted"
    alert = f"roll-out {id} goes back by itself: {view.note}"
    assert [each["alert"] for each in cars.live_messages if each["alert"]] == [alert]
    assert {each["id"] for each in cars.live_messages} == {id}


def test_who_looks_at_a_rollout_is_told_what_is_new_and_when_it_ends(cars):
    def news():
        told, cars.live_messages[:] = [*cars.live_messages], []
        return told

    id = cars.start(stages=[1, "100%"], wait=3600)
    cars.runner.run_once()
    (canary,) = cars.reached(id)
    message = {"type": "rollout", "id": id, "alert": ""}
    assert news() == [message]
    cars.answer()
    cars.run()
    assert news() == []  # within the second
    cars.run(1)
    assert news() == [message]
    cars.run(1, steps=5)
    assert news() == []
    cars.fleet.states[canary] = BAD
    cars.control("pause", id)
    cars.run(1)
    assert [bool(each["alert"]) for each in news()] == [True, False]
    cars.run(1)
    assert news() == []
    other = cars.start(robots=RobotSelection(names=[canary]))
    cars.run(1)
    cars.control("cancel", other, keep=True)
    cars.run(1)
    assert [each["id"] for each in news()] == [other, other]


def test_what_somebody_takes_back_is_no_alert(site):
    taken_back, kept, done = (
        site.start(robots=RobotSelection(names=[robot]), wait=0) for robot in site.robots[:3]
    )
    site.control("pause", kept)
    site.run()
    site.control("cancel", taken_back)
    site.control("cancel", kept, keep=True)
    site.run(60, steps=3)
    states = [site.view(id).state for id in (taken_back, kept, done)]
    assert states == ["reverted", "cancelled", "done"]
    assert [each for each in site.live_messages if each["alert"]] == []


def test_a_restart_gives_the_alert_no_second_time(site):
    id = site.start()
    site.run()
    site.fleet.states[site.reached(id)[0]] = BAD
    site.run(1)
    again = site.restarted()
    again.run(1, steps=3)
    assert again.live_messages == []


@pytest.mark.parametrize(
    ("kind", "run", "problem"),
    [
        (EventKind.ALARM, "r1", Problem.ALARM),
        (EventKind.STOP, "r1", Problem.STOPPED),
        (EventKind.GUARD, "r2", Problem.RESTARTED),
    ],
)
def test_what_events_tell_is_seen_though_it_is_over(cars, kind, run, problem):
    for robot in cars.robots:
        cars.tell(robot, EventKind.COUNTS)
    id = cars.start()
    cars.run()
    (canary,) = cars.reached(id)
    cars.tell(canary, kind, run, number=2)
    cars.run(1)
    view = cars.view(id)
    assert (view.state, view.problems) == ("reverted", {problem: 1})


def test_what_was_so_before_is_no_problem(cars):
    for robot in cars.robots:
        cars.tell(robot, EventKind.STOP)
        cars.fleet.states[robot] = BAD
    id = cars.start(stages=["100%"])
    cars.run()
    for robot in cars.robots:
        cars.tell(robot, EventKind.STOP, number=2)
        cars.tell(robot, EventKind.GUARD, number=3)
    cars.run(60, steps=2)
    assert (cars.view(id).state, cars.view(id).problems) == ("done", {})


def test_a_guard_that_refuses(site):
    site.refusing = set(site.robots)
    id = site.start()
    site.run(0, steps=2)
    view = site.view(id)
    assert (view.state, view.problems) == ("reverted", {Problem.REFUSED: 1})


def test_a_guard_that_goes(site):
    id = site.start()
    site.run()
    site.fleet.off = set(site.reached(id))
    site.run(1)
    site.run(29)
    assert site.view(id).state == "running"
    site.run(1)
    assert (site.view(id).state, site.view(id).problems) == ("reverted", {Problem.GONE: 1})


def test_robots_that_were_off_catch_up(cars):
    cars.fleet.off = {"car3", "car7"}
    id = cars.start(stages=["100%"])
    cars.run()
    cars.run(60)
    assert (cars.view(id).state, cars.view(id).waiting) == ("done", 2)
    cars.fleet.off = {"car7"}
    cars.run(100_000)
    assert (cars.view(id).waiting, policy(cars, "car3")) == (1, PolicyName.BLOCK)
    cars.fleet.off, cars.fleet.states["car7"] = set(), GuardState(at=0, revision=0)
    cars.run(1)
    cars.fleet.states["car7"] = BAD
    cars.run(1)
    view = cars.view(id)
    assert (view.state, view.sent, view.reverted) == ("done", 9, 1)
    assert policy(cars, "car7") is None


def test_a_restart_goes_on_where_it_was(cars):
    id = cars.start(stages=[1, "50%", "100%"])
    cars.run()
    cars.run(60)
    again = cars.restarted()
    assert len(again.reached(id)) == 5
    again.run(59)
    assert len(again.reached(id)) == 5
    bad = again.reached(id)[2]
    again.fleet.states[bad] = BAD
    again = again.restarted()
    again.run(1)
    assert (again.view(id).state, again.view(id).reverted) == ("reverted", 5)
    assert {policy(again, robot) for robot in again.robots} == {None}


@pytest.mark.parametrize("when", ["before the change", "after the change"])
def test_a_kill_in_the_middle_of_a_send_loses_nothing(site, monkeypatch, when):
    world = site.world
    world.controller.change(
        ANN,
        "car0",
        SettingsChange(revision=0, nodes={"drive": {"policy": "Preemption"}}, reason="by hand"),
    )
    change = world.controller.change

    def killed(*arguments):
        if when == "after the change":
            change(*arguments)
        raise KeyboardInterrupt

    monkeypatch.setattr(world.controller, "change", killed)
    id = site.start(robots=RobotSelection(names=["car0"]))
    with pytest.raises(KeyboardInterrupt):
        site.run()
    again = site.restarted()
    assert [each.phase for each in again.members(id)] == ["sending"]
    again.run()
    assert policy(again, "car0") is PolicyName.BLOCK
    again.control("cancel", id)
    again.run()
    assert policy(again, "car0") is PolicyName.PREEMPTION


def test_pause_resume_cancel(cars):
    id = cars.start(stages=["50%", "100%"])
    cars.run()
    cars.control("pause", id)
    cars.run(1000)
    assert (cars.view(id).state, cars.view(id).note, cars.view(id).sent) == (
        "paused",
        "ann: lunch",
        5,
    )
    cars.control("resume", id)
    cars.run()
    assert cars.view(id).sent == 10
    cars.control("cancel", id)
    cars.run()
    assert (cars.view(id).state, cars.view(id).reverted) == ("reverted", 10)
    for action in ("pause", "resume", "cancel"):
        with pytest.raises(ConflictError, match="is reverted"):
            cars.control(action, id)


def test_cancelled_where_it_is(site):
    id = site.start(stages=["50%", "100%"])
    site.run()
    site.control("cancel", id, keep=True)
    site.run(1000)
    assert (site.view(id).state, site.view(id).sent) == ("cancelled", 5)


def test_the_log_is_whole_after_a_change_went_back(site):
    id = site.start(stages=["100%"])
    site.run()
    site.control("cancel", id)
    site.run()
    with snapshot(site.world.database) as session:
        report = check_database(session, {}, ())
        lengths = {each.name: each.number for each in all_chains(session)}
        actions = list(session.scalars(select(AuditRow.action)))
    assert report.is_whole, report.faults
    assert actions.count("settings.take_back") == len(site.robots)
    assert lengths["service"] == sum(each.startswith("rollout") for each in actions)


def test_what_somebody_else_has_set_since_is_not_taken_back(site):
    id = site.start(stages=["100%"])
    site.run()
    revision = history(site, "car1")[0].revision
    nodes = {"drive": {"policy": "FIFO_Queue", "release_after": "1 s"}}
    by_hand = SettingsChange(revision=revision, nodes=nodes, reason="by hand")
    site.world.controller.change(ANN, "car1", by_hand)
    site.control("cancel", id)
    site.run()
    assert (policy(site, "car1"), policy(site, "car2")) == (PolicyName.FIFO_QUEUE, None)


def test_an_emergency_stop_stays_when_a_change_goes_back(site):
    id = site.start(stages=["100%"])
    site.run()
    site.world.controller.start_emergency_stop(ANN, "car1", "child")
    site.control("cancel", id)
    site.run()
    with site.world.database.session() as session:
        assert load_snapshot(session, "car1").settings.stop.reason == "child"


def test_who_lost_the_rights_changes_no_further_robot(site):
    id = site.start(stages=["50%", "100%"])
    site.run()
    with site.world.database.session() as session:
        set_groups(get_user(session, "ann"), ["hall-a"])
    site.run(60)
    site.run()
    view = site.view(id)
    assert (view.state, view.sent) == ("paused", 5)
    assert "is in no group of ann" in view.note


@pytest.mark.parametrize(
    ("who", "nodes", "error"),
    [
        (END_USER, NODES, ForbiddenError),
        (ANN, {"drive": {"policy": "Blok"}}, InputError),
        (ANN, {"none": {"policy": "Block"}}, InputError),
        (caller(name="nobody"), NODES, ForbiddenError),
        (
            Principal(
                name="tom", roles=frozenset({UserRole.DEVELOPER}), groups=frozenset({"hall-a"})
            ),
            NODES,
            ForbiddenError,
        ),
    ],
)
def test_what_one_robot_could_not_take_is_not_begun(site, who, nodes, error):
    with pytest.raises(error, match="car0"):
        site.start(who, nodes)
    site.run(1000)
    assert {policy(site, robot) for robot in site.robots} == {None}


def test_pause_takes_the_groups_and_resume_the_rights(site):
    id = site.start(stages=["50%", "100%"])
    stranger = Principal(
        name="tom", roles=frozenset({UserRole.DEVELOPER}), groups=frozenset({"hall-a"})
    )
    with pytest.raises(ForbiddenError):
        site.control("pause", id, stranger)
    site.control("pause", id, END_USER)
    for action in ("resume", "cancel"):
        with pytest.raises(ForbiddenError):
            site.control(action, id, END_USER)


def test_a_robot_is_in_one_rollout_at_a_time(site):
    first = site.start(robots=RobotSelection(names=["car1", "car2"]))
    with pytest.raises(ConflictError, match=f"car1 is in roll-out {first} already"):
        site.start()
    site.control("cancel", first, keep=True)
    site.start()


def test_robots_that_are_not_known(site):
    with pytest.raises(NotFoundError, match="no guard of zz has said hello"):
        site.start(robots=RobotSelection(names=["car1", "zz"]))
    with pytest.raises(NotFoundError):
        site.start(robots=RobotSelection(label="none"))
