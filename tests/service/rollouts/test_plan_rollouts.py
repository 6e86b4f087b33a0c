"""Another plan that goes out in stages, and comes back, with the settings that fit it."""

from random import Random

import pytest
from controller_setup import DEVELOPER, END_USER, PLAN, hello, plan, plan_with
from rollout_setup import ANN, RolloutSetup

from rtron.errors import InputError, PlanError
from rtron.service.controller.robot_snapshot import load_snapshot
from rtron.service.domain.errors import ForbiddenError
from rtron.service.domain.principal import UserRole
from rtron.service.domain.rollouts.schemas import NewRollout, RobotSelection
from rtron.service.domain.schemas import SettingsChange
from rtron.service.store.accounts.users import add_user, get_user, set_disabled
from rtron.service.store.database import Database
from rtron.service.store.fleet.labels import replace_members
from rtron.service.store.robots import find_robot
from rtron.service.store.settings import load_settings
from rtron.vocabulary import (
    Alarm,
    AlarmKind,
    EventKind,
    GuardState,
    Mode,
    StreamState,
    VerdictCounts,
)
from rtron.wire.common.link_protocol import plan_document_digest

OTHER = PLAN.replace("priority: 2", "priority: 3").replace("0.02 m/frame", "0.01 m/frame")
DIGEST = plan_document_digest(OTHER)
BAD = GuardState(at=0, revision=0, alarms=(Alarm(kind=AlarmKind.DRIFT, reason="why"),))


@pytest.fixture
def site(database_file):
    opened = Database(database_file)
    yield opened
    opened.close()


def plans(cars):
    with cars.world.database.session() as session:
        rows = [load_snapshot(session, robot).row for robot in cars.robots]
        return [load_settings(row).plan for row in rows]


def test_a_plan_reaches_all_in_stages(cars):
    id = cars.start(plan=OTHER, stages=[1, "30%", "100%"])
    reached = []
    for seconds in (0, 60, 60, 60):
        cars.run(seconds)
        reached.append(plans(cars).count(DIGEST))
    assert reached == [1, 3, 10, 10]
    view = cars.view(id)
    assert (view.state, view.applied, view.plan, view.nodes) == ("done", 10, DIGEST, {})


def test_a_bad_plan_goes_back_from_the_canary(cars):
    id = cars.start(plan=OTHER)
    cars.run()
    (canary,) = cars.reached(id)
    cars.fleet.states[canary] = BAD
    cars.run(seconds=1, steps=3)
    assert cars.view(id).state == "reverted"
    assert plans(cars) == [""] * 10


def test_a_guard_that_refuses_or_knows_of_no_plans_ends_it(cars):
    for group in (cars.refusing, cars.planless):
        group.update(cars.robots)
        id = cars.start(plan=OTHER)
        cars.run(seconds=1, steps=3)
        assert (cars.view(id).state, cars.view(id).sent) == ("reverted", 0)
        assert set(plans(cars)) == {""}
        assert "refused: 1 of 1 robots" in cars.view(id).note
        group.clear()


def test_the_restart_for_the_plan_is_none_and_the_next_is_one(cars):
    for number, robot in enumerate(cars.robots):
        cars.tell(robot, EventKind.GUARD, "before", number + 1)
    id = cars.start(plan=OTHER)
    cars.run()
    (canary,) = cars.reached(id)
    cars.tell(canary, EventKind.GUARD, "with the plan")
    cars.run(seconds=1, steps=2)
    assert cars.view(id).problems == {}
    cars.tell(canary, EventKind.GUARD, "and again")
    cars.run(seconds=1, steps=2)
    assert cars.view(id).state == "reverted"


def counted(passed, dropped):
    flows = {"flow1": VerdictCounts(passed=passed, dropped=dropped)}
    return GuardState(
        at=0,
        revision=0,
        streams=(StreamState(topic="/cmd_vel", nodes=(), mode=Mode.ENFORCE, flows=flows),),
    )


@pytest.mark.parametrize(("dropped", "state"), [(20, "running"), (60, "reverted")])
def test_a_new_guard_counts_its_messages_anew(cars, dropped, state):
    cars.fleet.states.update(dict.fromkeys(cars.robots, counted(9_000, 1_000)))
    id = cars.start(plan=OTHER)
    cars.run()
    (canary,) = cars.reached(id)
    cars.fleet.states[canary] = counted(200, dropped)
    cars.run(seconds=1, steps=2)
    assert cars.view(id).state == state


def test_a_plan_that_is_bad_on_a_few_reaches_no_more_than_the_stage_after_the_canary(site):
    fleet = RolloutSetup(site, 100).meet()
    bad = Random(1).sample(fleet.robots, 3)
    with fleet.world.database.session() as session:
        replace_members(session, "old", [find_robot(session, each)[0].id for each in bad])
    id, most = fleet.start(plan=OTHER), 0
    for _ in range(20):
        fleet.run(seconds=30)
        most = max(most, sum(each == DIGEST for each in plans(fleet)))
        given = zip(fleet.robots, plans(fleet), strict=True)
        fleet.fleet.states.update({name: BAD for name, plan in given if plan and name in bad})
    assert fleet.view(id).state == "reverted"
    assert (most <= 10, set(plans(fleet))) == (True, {""})


def test_settings_that_do_not_fit_the_plan_are_left_out(cars):
    nodes = {"drive": {"flows": {"flow2": {"priority": 3}}}}
    change = SettingsChange(revision=0, nodes=nodes, reason="visitors")
    cars.world.controller.change(DEVELOPER, "car0", change)
    cars.start(plan=OTHER, stages=["100%"])
    cars.run()
    with cars.world.database.session() as session:
        assert load_snapshot(session, "car0").settings.nodes == {}


def test_robots_that_were_off_get_the_plan_later(cars):
    cars.fleet.off = {"car3"}
    cars.start(plan=OTHER, stages=["100%"])
    cars.run(seconds=30, steps=4)
    assert plans(cars)[3] == ""
    cars.fleet.off = set()
    cars.run(seconds=1, steps=2)
    assert plans(cars)[3] == DIGEST


def test_the_plan_before_comes_back_and_not_the_first(cars):
    cars.start(plan=OTHER, stages=["100%"], wait=1)
    cars.run(seconds=30, steps=3)
    id = cars.start(plan=PLAN, stages=["100%"], wait=1)
    cars.run(seconds=30, steps=3)
    assert set(plans(cars)) == {plan_document_digest(PLAN)}
    cars.control("cancel", id)
    cars.run(seconds=1, steps=2)
    assert set(plans(cars)) == {DIGEST}


def test_settings_and_stops_of_others_stay_when_the_plan_goes_back(cars):
    id = cars.start(plan=OTHER, stages=["100%"])
    cars.run()
    cars.world.controller.start_emergency_stop(DEVELOPER, "car0", "a child")
    cars.answer()
    cars.control("cancel", id)
    cars.run(seconds=1, steps=2)
    with cars.world.database.session() as session:
        settings = load_snapshot(session, "car0").settings
    assert (settings.plan, settings.stop.reason) == ("", "a child")


def test_a_stop_goes_out_again_without_a_plan_that_is_refused(cars):
    cars.world.controller.start_emergency_stop(DEVELOPER, "car0", "a child")
    cars.answer()
    cars.planless.add("car0")
    cars.start(plan=OTHER, stages=["100%"])
    cars.run()
    _, settings = [each for each in cars.world.guards.pushed if each[0] == "car0"][-1]
    assert (settings.plan, settings.stop.reason) == ("", "a child")


def test_a_plan_that_needs_a_launch_is_not_begun(cars):
    cars.world.controller.handle_hello("car4", hello(plan_with("/base]", "/base2]")))
    with pytest.raises(InputError, match="car4: the plan needs a new launch: grcn drive: succ"):
        cars.start(plan=OTHER)


def test_a_plan_that_rtron_check_refuses_is_not_begun(cars):
    with pytest.raises(PlanError, match="priority"):
        cars.start(plan=OTHER.replace("priority: 3", "priority: high"))


def test_a_new_plan_takes_the_role_developer(cars):
    with pytest.raises(ForbiddenError, match="developer"):
        cars.start(END_USER, plan=OTHER)


def test_a_change_is_either_of_settings_or_a_plan():
    for values in ({"plan": OTHER, "nodes": {"drive": {}}}, {}):
        with pytest.raises(ValueError, match="give nodes, or a plan"):
            NewRollout(robots=RobotSelection(app="small"), reason="visitors", **values)


def test_a_robot_that_changes_its_plan_before_its_turn_refuses(cars):
    cars.fleet.off = {"car4"}
    id = cars.start(plan=OTHER, stages=["100%"])
    cars.run()
    cars.world.controller.handle_hello("car4", hello(plan_with("/base]", "/base2]")))
    cars.fleet.off = set()
    cars.run(seconds=1, steps=1)
    member = next(each for each in cars.members(id) if each.robot == "car4")
    assert member.problems == ["refused"]
    assert DIGEST not in plans(cars)


def test_who_began_it_needs_the_role_until_the_end(cars):
    id = cars.start(plan=OTHER)
    with cars.world.database.session() as session:
        add_user(session, 0, "root", "no hash", [UserRole.ADMIN])
        set_disabled(session, get_user(session, ANN.name), disabled=True)
    cars.run()
    assert (cars.view(id).state, cars.view(id).sent) == ("paused", 0)


def test_the_plan_of_the_test_is_another():
    assert plan(OTHER) != plan()
