"""The risk controller on a real database: revisions, rights, the audit log, the stop."""

import re
from contextlib import suppress
from dataclasses import replace
from threading import Barrier, Thread

import pytest
from controller_setup import (
    ADMIN,
    DEVELOPER,
    DEVELOPER_AND_END_USER,
    END_USER,
    ControllerSetup,
    RecordingChannel,
    caller,
    hello,
    plan,
    plan_with,
)
from pydantic import ValidationError
from sqlalchemy import select
from sqlalchemy.exc import OperationalError

from rtron.errors import InputError, SourceError, WireError
from rtron.service.controller.robot_snapshot import load_snapshot
from rtron.service.domain.errors import ConflictError, ForbiddenError, NotFoundError
from rtron.service.domain.revisions import StaleRevisionError
from rtron.service.domain.schemas import (
    OverrideEnd,
    OverrideRequest,
    ReleaseRequest,
    SettingsChange,
    SettingsOutcome,
)
from rtron.service.store.chain_check import check_database
from rtron.service.store.database import Database
from rtron.service.store.robots import coordination_nodes
from rtron.service.store.settings import list_settings, settings_view
from rtron.service.store.tables import AuditRow
from rtron.vocabulary import (
    SECOND,
    EmergencyStop,
    FlowSettings,
    NodeSettings,
    PolicyName,
    RuleSettings,
    Settings,
    TimedOverride,
)
from rtron.wire.common.link_protocol import Applied

BLOCK = {"drive": {"policy": "Block"}}
BLOCKED = {"drive": NodeSettings(policy=PolicyName.BLOCK)}


def change(revision, nodes=None, reason="why"):
    return SettingsChange(revision=revision, nodes=nodes or BLOCK, reason=reason)


def release(world, who, revision=None, reason="all clear"):
    if revision is None:
        revision = newest(world).revision
    request = ReleaseRequest(revision=revision, reason=reason)
    return world.controller.release_emergency_stop(who, "r2", request)


def audit(world):
    with world.database.session() as session:
        return list(session.scalars(select(AuditRow).order_by(AuditRow.id)))


def audit_actions(world):
    return [(row.who, row.action, row.outcome) for row in audit(world)]


def newest(world, robot="r2"):
    with world.database.session() as session:
        return settings_view(load_snapshot(session, robot).row)


def views(world, robot="r2"):
    with world.database.session() as session:
        app = load_snapshot(session, robot).app
        return [settings_view(row) for row in list_settings(session, app.id, None, 100)]


def nodes(world):
    with world.database.session() as session:
        return list(coordination_nodes(session, load_snapshot(session, "r2").app.id))


def test_a_first_hello_is_revision_0(world):
    assert world.controller.handle_hello("r2", hello(plan())) == Settings()
    view = newest(world)
    assert (view.revision, view.outcome, view.by) == (0, SettingsOutcome.PENDING, "rtron")
    assert [told["type"] for told in world.guards.messages] == ["settings"]
    assert (
        audit_actions(world)
        == [("guard:r2", "plan", "done"), ("guard:r2", "settings", "done")][::-1]
    )


def test_a_hello_again_changes_nothing(met):
    before = audit_actions(met)
    assert met.controller.handle_hello("r2", hello(plan())) == Settings()
    assert len(views(met)) == 1
    assert audit_actions(met) == before


def test_a_dry_run_is_noted_once_for_each_life_of_a_guard(met):
    for run in ("r1", "r1", "r2", "r2"):
        met.controller.handle_hello("r2", replace(hello(plan(), dry_run=True), run=run))
    assert [row.action for row in audit(met)].count("dry_run") == 2


def test_the_risk_model_of_each_node_is_kept(controller_on_each_database):
    found = {row.node: row for row in nodes(controller_on_each_database)}
    assert list(found) == ["drive", "speed", "mission", "eyes"]
    assert [row.type for row in found.values()] == ["GRCN", "RSRCN", "MSRCN", "fps_monitor"]
    assert found["drive"].description == (
        "Decides which of /teleop, /planner controls /cmd_vel, before /base."
    )
    assert found["speed"].description == (
        "Limits the velocity on /max_vel to what the image nodes can follow."
    )
    assert found["drive"].risk_information["risks"][0]["id"] == "GR-ST:/cmd_vel"
    assert found["drive"].policy_settings["policy"] == "Preemption"


def test_a_change_is_stored_sent_and_told(controller_on_each_database):
    controller_on_each_database.clock.now = 77
    view = controller_on_each_database.controller.change(DEVELOPER, "r2", change(0))
    assert (view.revision, view.by, view.reason, view.at) == (1, "dev", "why", 77)
    assert view.settings.nodes == BLOCKED
    assert controller_on_each_database.guards.pushed == [
        ("r2", Settings(revision=1, nodes=BLOCKED))
    ]
    assert controller_on_each_database.guards.messages[-1]["view"] == view.model_dump(mode="json")
    assert newest(controller_on_each_database) == view
    assert nodes(controller_on_each_database)[0].policy_settings["policy"] == "Block"
    detail = dict(audit(controller_on_each_database)[-1].detail)
    assert detail.pop("settings")["revision"] == 1
    assert detail == {"revision": 0, "nodes": '{"drive": {"policy": "Block"}}', "reason": "why"}
    assert audit(controller_on_each_database)[-1].address == "10.0.0.7"


def test_it_is_in_the_database_before_the_guard_hears_of_it(met):
    seen = []
    met.guards.push = lambda robot, settings: seen.append((settings.revision, newest(met).revision))
    met.controller.change(DEVELOPER, "r2", change(0))
    met.controller.start_emergency_stop(DEVELOPER, "r2", "fire")
    assert seen == [(1, 1), (2, 2)]


def test_what_was_answered_is_there_after_a_restart(controller_on_each_database):
    view = controller_on_each_database.controller.change(DEVELOPER, "r2", change(0))
    again = controller_on_each_database.restarted()
    assert again.controller.handle_hello("r2", hello(plan())) == view.settings
    again.database.close()


@pytest.mark.parametrize("revision", [0, 2, 99])
def test_a_change_of_another_revision_is_overtaken(met, revision):
    view = met.controller.change(DEVELOPER, "r2", change(0))
    with pytest.raises(StaleRevisionError) as caught:
        met.controller.change(DEVELOPER, "r2", change(revision, {"drive": {"policy": None}}))
    assert caught.value.newest == view
    assert len(met.guards.pushed) == 1
    assert audit_actions(met)[-1] == ("dev", "settings", f"refused: {caught.value}")


def test_a_change_that_changes_nothing_makes_no_revision(met):
    met.controller.change(DEVELOPER, "r2", change(0))
    assert met.controller.change(DEVELOPER, "r2", change(1)).revision == 1
    assert len(views(met)) == 2


@pytest.mark.parametrize(
    ("who", "nodes", "missing"),
    [
        (END_USER, BLOCK, "select_policy at drive"),
        (DEVELOPER, {"speed": {"policy": "Constrain"}}, "select_policy at speed"),
        (DEVELOPER, {"speed": {"max_vel_limit": 0.1}}, "set_max_vel_limit at speed"),
        (END_USER, {"speed": {"threshold": 0.1}}, "set_threshold at speed"),
        (ADMIN, BLOCK, "select_policy at drive"),
        (caller(name="token"), BLOCK, "select_policy at drive"),
        (
            DEVELOPER_AND_END_USER,
            {"mission": {"flows": {"aflow1": {"priority": 3}}}},
            "set_priority at mission",
        ),
    ],
)
def test_who_lacks_the_right_is_refused_and_noted(met, who, nodes, missing):
    with pytest.raises(ForbiddenError, match=f"may not {missing}$"):
        met.controller.change(who, "r2", change(0, nodes))
    assert audit_actions(met)[-1][0] == who.name
    assert audit_actions(met)[-1][2].startswith("refused: ")
    assert (newest(met).revision, met.guards.pushed) == (0, [])


def test_what_is_mandatory_stays(met):
    off = {"mission": {"rules": {"quiet": {"selected": False}}}}
    with pytest.raises(ForbiddenError, match="quiet of mission is mandatory"):
        met.controller.change(DEVELOPER_AND_END_USER, "r2", change(0, off))


def test_what_makes_no_plan_is_refused(met):
    same = {"drive": {"flows": {"flow1": {"priority": 1}}}}
    with pytest.raises(InputError, match="the same priority"):
        met.controller.change(DEVELOPER, "r2", change(0, same))
    assert audit_actions(met)[-1][2].startswith("refused: flow1 and flow2")


@pytest.mark.parametrize(("robot", "told"), [("r3", "no such robot"), ("", "no such robot")])
def test_an_unknown_robot(met, robot, told):
    with pytest.raises(NotFoundError, match=told):
        met.controller.change(DEVELOPER, robot, change(0))
    with pytest.raises(NotFoundError, match=told):
        met.controller.start_emergency_stop(DEVELOPER, robot, "")


def test_long_changes_are_cut_in_the_audit_log(controller_on_each_database):
    nodes = {"drive": {"flows": {f"flow{i}": {"priority": i} for i in range(1000)}}}
    with pytest.raises(InputError):
        controller_on_each_database.controller.change(DEVELOPER, "r2", change(0, nodes))
    assert len(audit(controller_on_each_database)[-1].detail["nodes"]) == 2000


def test_of_two_changes_at_once_one_is_overtaken(controller_on_each_database):
    both, outcomes = Barrier(2), []

    def ask(limit):
        both.wait()
        try:
            controller_on_each_database.controller.change(
                END_USER, "r2", change(0, {"speed": {"max_vel_limit": limit}})
            )
            outcomes.append(limit)
        except StaleRevisionError:
            outcomes.append(None)

    threads = [Thread(target=ask, args=(limit,)) for limit in (0.1, 0.2)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    (won,) = filter(None, outcomes)
    assert newest(controller_on_each_database).settings.nodes["speed"].max_vel_limit == won
    assert newest(controller_on_each_database).revision == 1


# What the guard says.


def test_what_the_guard_applies_is_applied_and_older_ones_are_replaced(controller_on_each_database):
    controller_on_each_database.controller.change(DEVELOPER, "r2", change(0))
    controller_on_each_database.controller.change(
        DEVELOPER, "r2", change(1, {"drive": {"policy": None}})
    )
    controller_on_each_database.clock.now = 99
    controller_on_each_database.controller.handle_applied("r2", Applied(revision=2))
    assert [view.outcome for view in views(controller_on_each_database)] == [
        "applied",
        "replaced",
        "replaced",
    ]
    assert {view.answered for view in views(controller_on_each_database)} == {99}
    assert controller_on_each_database.guards.messages[-1]["view"]["outcome"] == "applied"
    assert audit_actions(controller_on_each_database)[-1] == (
        "guard:r2",
        "settings.answer",
        "applied",
    )


def test_an_answer_that_is_said_again_is_noted_once(met):
    met.controller.handle_applied("r2", Applied(revision=0))
    before, told = audit_actions(met), len(met.guards.messages)
    met.controller.handle_applied("r2", Applied(revision=0))
    assert (audit_actions(met), len(met.guards.messages)) == (before, told)


def test_refused_settings_stay_refused_and_go_out_with_the_next_hello(met):
    met.controller.change(DEVELOPER, "r2", change(0))
    met.controller.handle_applied("r2", Applied(revision=1, error="no such flow" + "w" * 2000))
    view = newest(met)
    assert (view.outcome, view.error[:12], len(view.error)) == ("refused", "no such flow", 1000)
    assert met.controller.handle_hello("r2", hello(plan())).revision == 1
    assert newest(met).outcome == "refused"
    assert len(met.guards.pushed) == 1


def test_settings_that_were_refused_can_be_applied_later(met):
    met.controller.handle_applied("r2", Applied(revision=0, error="busy"))
    met.controller.handle_applied("r2", Applied(revision=0))
    assert (newest(met).outcome, newest(met).error) == ("applied", "")


def test_an_answer_to_nothing_is_ignored(met, caplog):
    met.controller.handle_applied("r2", Applied(revision=7))
    assert "answers revision 7" in caplog.text
    assert len(views(met)) == 1


# Hello under another plan.


def test_settings_that_no_longer_fit_are_left_out_as_a_new_revision(controller_on_each_database):
    two = {**BLOCK, "speed": {"threshold": 0.5}}
    controller_on_each_database.controller.change(DEVELOPER, "r2", change(0, two))
    sent = controller_on_each_database.controller.handle_hello(
        "r2", hello(plan_with("id: drive", "id: wheels"), revision=1)
    )
    assert sent == Settings(revision=2, nodes={"speed": NodeSettings(threshold=0.5)})
    assert newest(controller_on_each_database).reason.startswith(
        "the plan has changed, left out: no coordination node"
    )
    assert [row.node for row in nodes(controller_on_each_database)] == [
        "wheels",
        "speed",
        "mission",
        "eyes",
    ]
    assert (
        controller_on_each_database.controller.handle_hello(
            "r2", hello(plan_with("id: drive", "id: wheels"))
        ).revision
        == 2
    )


def test_settings_that_fit_go_on_under_a_new_plan(met):
    met.controller.change(DEVELOPER, "r2", change(0))
    sent = met.controller.handle_hello("r2", hello(plan_with("priority: 2", "priority: 3")))
    assert sent == Settings(revision=1, nodes=BLOCKED)


def test_an_emergency_stop_goes_on_under_a_new_plan(met):
    met.controller.start_emergency_stop(DEVELOPER, "r2", "fire")
    sent = met.controller.handle_hello("r2", hello(plan_with("id: drive", "id: wheels")))
    assert sent.stop.reason == "fire"


def test_a_guard_with_newer_settings_is_never_asked_to_go_back(met):
    assert met.controller.handle_hello("r2", hello(plan(), revision=41)).revision == 42
    assert newest(met).reason == "the guard had revision 41, which was not in the database"


STOP = EmergencyStop(by="ann", reason="fire", at=7)


def test_of_a_guards_settings_only_the_stop_is_taken_over(met):
    """A robot's token may have been stolen: nobody has checked who may set the rest."""
    own = {"mission": NodeSettings(rules={"quiet": RuleSettings(selected=False)})}
    override = TimedOverride(by="ann", reason="docking", until=1 << 60)
    theirs = Settings(revision=9, nodes={**BLOCKED, **own}, overrides={"speed": override})
    met.controller.change(DEVELOPER, "r2", change(0, {"speed": {"threshold": 0.5}}))
    kept = newest(met).settings
    sent = met.controller.handle_hello("r2", hello(plan(), settings=replace(theirs, stop=STOP)))
    assert sent == replace(kept, revision=10, stop=STOP)
    assert newest(met).settings == sent


@pytest.mark.parametrize("stop", [None, STOP])
@pytest.mark.parametrize("revision", [0, 1, 2, 9])
def test_no_hello_ends_or_replaces_a_stop(met, stop, revision):
    mine = met.controller.start_emergency_stop(DEVELOPER, "r2", "flood").settings.stop
    theirs = Settings(revision=revision, stop=stop)
    for app in ("small", "other"):
        assert (
            met.controller.handle_hello("r2", hello(plan(), settings=theirs, app=app)).stop == mine
        )


def test_a_stop_of_a_guard_at_a_known_revision_is_not_taken_over(met):
    """It has been ended meanwhile."""
    met.controller.start_emergency_stop(DEVELOPER, "r2", "fire")
    release(met, DEVELOPER)
    for revision in (1, 2):
        theirs = Settings(revision=revision, stop=STOP)
        assert met.controller.handle_hello("r2", hello(plan(), settings=theirs)).stop is None


def test_the_words_of_a_guards_stop_are_cut(met):
    long = EmergencyStop(by="a" * 900, reason="b" * 9000, at=7)
    sent = met.controller.handle_hello(
        "r2", hello(plan(), settings=Settings(revision=9, stop=long))
    )
    assert (len(sent.stop.by), len(sent.stop.reason)) == (200, 200)


def test_what_the_database_has_is_not_taken_from_the_guard(met):
    theirs = Settings(revision=0, nodes=BLOCKED)
    assert met.controller.handle_hello("r2", hello(plan(), settings=theirs)).nodes == {}


def test_each_app_has_settings_of_its_own(met):
    met.controller.change(DEVELOPER, "r2", change(0))
    assert met.controller.handle_hello("r2", hello(plan(), app="other")) == Settings()
    assert met.controller.handle_hello("r2", hello(plan())).revision == 1


def test_the_stop_goes_on_under_another_app(controller_on_each_database):
    stop = controller_on_each_database.controller.start_emergency_stop(
        DEVELOPER, "r2", "fire"
    ).settings.stop
    controller_on_each_database.controller.change(DEVELOPER, "r2", change(1))
    assert controller_on_each_database.controller.handle_hello(
        "r2", hello(plan(), app="other")
    ) == Settings(revision=1, stop=stop)
    assert newest(controller_on_each_database).reason == "the robot is stopped, under another app"
    assert (
        audit(controller_on_each_database)[-1].detail["reason"]
        == "the robot is stopped, under another app"
    )
    release(controller_on_each_database, END_USER)
    back = controller_on_each_database.controller.handle_hello("r2", hello(plan(), revision=2))
    assert back == Settings(revision=3, nodes=BLOCKED)
    assert (
        newest(controller_on_each_database).reason
        == "the emergency stop has been ended meanwhile, under another app"
    )
    assert (
        controller_on_each_database.controller.handle_hello("r2", hello(plan(), app="other")).stop
        is None
    )


def test_a_stop_under_another_app_is_there_when_the_first_comes_back(met):
    met.controller.handle_hello("r2", hello(plan(), app="other"))
    stop = met.controller.start_emergency_stop(DEVELOPER, "r2", "fire").settings.stop
    assert met.controller.handle_hello("r2", hello(plan())).stop == stop
    assert met.controller.handle_hello("r2", hello(plan())).revision == 1


def test_hellos_that_change_something_are_counted(met):
    met.clock.now = 90 * SECOND
    for number in range(10):
        met.controller.handle_hello("r2", hello(plan(), revision=2 * number + 1))
    with pytest.raises(InputError, match="more than 10 hellos within a minute"):
        met.controller.handle_hello("r2", hello(plan(), revision=99))
    assert newest(met).revision == 20
    with pytest.raises(InputError):
        met.controller.handle_hello("r2", hello(plan(), app="other"))
    assert met.controller.handle_hello("r2", hello(plan(), revision=20)).revision == 20
    met.controller.handle_hello("r3", hello(plan()))
    met.clock.now += 60 * SECOND
    assert met.controller.handle_hello("r2", hello(plan(), revision=99)).revision == 100


def test_an_override_that_is_over_does_not_go_out(met):
    request = OverrideRequest(duration=2, reason="docking")
    met.clock.now = 10 * SECOND
    met.controller.start_override(END_USER, "r2", "speed", request)
    met.clock.now = 12 * SECOND - 1
    assert list(met.controller.handle_hello("r2", hello(plan())).overrides) == ["speed"]
    met.clock.now = 12 * SECOND
    assert met.controller.handle_hello("r2", hello(plan())) == Settings(revision=1)
    met.controller.change(DEVELOPER, "r2", change(1))
    assert newest(met).settings.overrides == {}


@pytest.mark.parametrize(
    "odd",
    [
        hello(replace(plan(), grcn=(replace(plan().grcn[0], id="a b"),))),
        hello(replace(plan(), grcn=(plan().grcn[0],) * 2)),
        hello(replace(plan(), grcn=(replace(plan().grcn[0], id="a" * 201),))),
        hello(plan(), app="a" * 201),
        hello(plan(), app="a\0"),
        replace(hello(plan()), run="r" * 41),
        replace(hello(plan()), run=""),
        replace(hello(plan()), run="\0"),
        hello(plan(), revision=-1),
        hello(plan(), revision=1 << 50),
    ],
)
def test_a_hello_that_no_guard_says_is_refused(world, odd):
    with pytest.raises(WireError):
        world.controller.handle_hello("r2", odd)
    with pytest.raises(NotFoundError):
        newest(world)


def test_the_guard_of_a_robot_with_the_longest_name_is_met(database):
    world, robot = ControllerSetup(database), "r" * 100
    world.controller.handle_hello(robot, hello(plan()))
    with database.session() as session:
        assert set(session.scalars(select(AuditRow.who))) == {f"guard:{robot}"[:100]}
        assert check_database(session, {}, ()).is_whole


def test_the_apps_of_a_robot_are_counted(world):
    for number in range(100):
        world.clock.now += 6 * SECOND
        world.controller.handle_hello("r2", hello(plan(), app=f"app{number}"))
    with pytest.raises(InputError, match="100 apps"):
        world.controller.handle_hello("r2", hello(plan(), app="one more"))
    world.clock.now += 6 * SECOND
    world.controller.handle_hello("r2", hello(plan(), app="app7"))


# Overrides.


@pytest.mark.parametrize("who", [DEVELOPER, END_USER])
@pytest.mark.parametrize("node", ["speed", "mission"])
def test_both_may_override_for_a_while(met, who, node):
    request = OverrideRequest(duration=0.5, reason="docking")
    view = met.controller.start_override(who, "r2", node, request)
    until = met.clock.now + SECOND // 2
    assert view.settings.overrides == {
        node: TimedOverride(by=who.name, reason="docking", until=until)
    }
    assert met.controller.end_override(who, "r2", node, "docked").settings.overrides == {}
    assert [settings.revision for _, settings in met.guards.pushed] == [1, 2]


@pytest.mark.parametrize(
    ("who", "node", "error"),
    [
        (DEVELOPER, "drive", ForbiddenError),
        (DEVELOPER_AND_END_USER, "drive", ForbiddenError),
        (ADMIN, "speed", ForbiddenError),
        (caller(), "speed", ForbiddenError),
        (DEVELOPER, "eyes", NotFoundError),
        (DEVELOPER, "spead", NotFoundError),
    ],
)
def test_nobody_else_and_nothing_else(met, who, node, error):
    request = OverrideRequest(duration=0.5, reason="docking")
    with pytest.raises(error):
        met.controller.start_override(who, "r2", node, request)
    with pytest.raises(error):
        met.controller.end_override(who, "r2", node, "docked")
    assert met.guards.pushed == []


def test_what_is_not_overridden_has_no_end(met):
    with pytest.raises(NotFoundError, match="speed is not overridden"):
        met.controller.end_override(DEVELOPER, "r2", "speed", "docked")


# The emergency stop.


@pytest.mark.parametrize("who", [DEVELOPER, END_USER, ADMIN])
def test_every_role_may_stop_and_release(met, who):
    met.clock.now = 5
    stop = EmergencyStop(by=who.name, reason="fire", at=5)
    view = met.controller.start_emergency_stop(who, "r2", "fire")
    assert (view.revision, view.settings) == (1, Settings(revision=1, stop=stop))
    assert met.guards.pushed == [("r2", Settings(revision=1, stop=stop))]
    view = release(met, who)
    assert (view.revision, view.settings.stop) == (2, None)
    assert [row.action for row in audit(met)[-2:]] == ["stop", "stop.end"]


def test_a_token_without_a_role_may_not(met):
    with pytest.raises(ForbiddenError):
        met.controller.start_emergency_stop(caller(), "r2", "")
    met.controller.start_emergency_stop(END_USER, "r2", "")
    with pytest.raises(ForbiddenError):
        release(met, caller())


def test_the_same_stop_goes_out_again_while_it_is_not_confirmed(met):
    first = met.controller.start_emergency_stop(DEVELOPER, "r2", "fire")
    second = met.controller.start_emergency_stop(DEVELOPER, "r2", "fire")
    assert (second.revision, second.settings.stop) == (2, first.settings.stop)
    assert met.guards.pushed == [("r2", first.settings), ("r2", second.settings)]
    met.controller.handle_applied("r2", Applied(revision=2))
    assert met.controller.start_emergency_stop(DEVELOPER, "r2", "fire").revision == 2
    assert len(met.guards.pushed) == 2


@pytest.mark.parametrize(("who", "reason"), [(END_USER, "fire"), (DEVELOPER, "flood")])
def test_anothers_stop_does_not_vanish_with_the_first(controller_on_each_database, who, reason):
    first = controller_on_each_database.controller.start_emergency_stop(DEVELOPER, "r2", "fire")
    controller_on_each_database.controller.handle_applied("r2", Applied(revision=1))
    second = controller_on_each_database.controller.start_emergency_stop(who, "r2", reason)
    stop = second.settings.stop
    assert (second.revision, stop.by, stop.reason) == (2, who.name, reason)
    with pytest.raises(StaleRevisionError) as caught:
        release(controller_on_each_database, DEVELOPER, first.revision)
    assert caught.value.newest == newest(controller_on_each_database) == second
    assert controller_on_each_database.guards.pushed[-1][1].stop == stop
    assert release(controller_on_each_database, DEVELOPER, 2).settings.stop is None


@pytest.mark.parametrize("revision", [0, 2, 1 << 52])
def test_the_end_is_of_the_newest_revision(met, revision):
    met.controller.start_emergency_stop(DEVELOPER, "r2", "fire")
    with pytest.raises(StaleRevisionError):
        release(met, DEVELOPER, revision)
    assert newest(met).settings.stop


@pytest.mark.parametrize("reason", ["", "ok", "  "])
def test_the_end_needs_a_reason(met, reason):
    met.controller.start_emergency_stop(DEVELOPER, "r2", "")
    with pytest.raises(InputError, match="needs a reason"):
        release(met, DEVELOPER, reason=reason)
    assert newest(met).settings.stop


UNSEEN = ["\u200b" * 5, "\x01\x02\x03\x04", "\u00ad\u202e \u200b"]


@pytest.mark.parametrize("reason", ["", "ok", *UNSEEN])
def test_a_change_and_the_end_of_an_override_need_a_reason(met, reason):
    met.controller.start_override(
        END_USER, "r2", "speed", OverrideRequest(duration=9, reason="dock")
    )
    for deed in (
        lambda: met.controller.change(DEVELOPER, "r2", change(1, reason=reason)),
        lambda: met.controller.end_override(
            END_USER, "r2", "speed", OverrideEnd(reason=reason).reason
        ),
    ):
        with pytest.raises(InputError, match="needs a reason"):
            deed()
    assert (newest(met).revision, list(newest(met).settings.overrides)) == (1, ["speed"])
    refused = [(row.action, row.outcome) for row in audit(met)[-2:]]
    assert refused == [
        ("settings", "refused: a change of settings needs a reason"),
        ("override.end", "refused: the end of an override needs a reason"),
    ]


@pytest.mark.parametrize("reason", UNSEEN)
def test_what_nobody_can_see_is_no_reason(met, reason):
    met.controller.start_emergency_stop(DEVELOPER, "r2", "")
    with pytest.raises(InputError, match="needs a reason"):
        release(met, DEVELOPER, reason=reason)
    with pytest.raises(ValidationError, match="say why"):
        OverrideRequest(duration=1, reason=reason)
    assert newest(met).settings.stop


def test_a_change_without_a_right_is_refused_where_it_changes_nothing(met):
    before = newest(met).revision
    with pytest.raises(ForbiddenError, match="may not"):
        met.controller.change(ADMIN, "r2", change(before, {"drive": {"policy": None}}))
    assert newest(met).revision == before


def test_nothing_to_release(met):
    with pytest.raises(NotFoundError, match="not stopped"):
        release(met, DEVELOPER)


def test_settings_can_change_while_stopped_and_the_stop_stays(met):
    met.controller.start_emergency_stop(DEVELOPER, "r2", "fire")
    view = met.controller.change(DEVELOPER, "r2", change(1))
    assert (view.settings.stop.reason, view.settings.nodes) == ("fire", BLOCKED)


def test_a_stop_is_never_overtaken(controller_on_each_database):
    """Many change settings; each stop goes on top of the newest all the same."""
    done, errors = Barrier(5), []

    def stop_and_release():
        done.wait()
        try:
            for _ in range(10):
                controller_on_each_database.controller.start_emergency_stop(END_USER, "r2", "")
                with suppress(NotFoundError, StaleRevisionError):
                    release(controller_on_each_database, END_USER)
        except Exception as error:  # noqa: BLE001 - told below
            errors.append(error)

    threads = [Thread(target=stop_and_release) for _ in range(5)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert errors == []
    controller_on_each_database.controller.start_emergency_stop(END_USER, "r2", "")
    revisions = [view.revision for view in views(controller_on_each_database)]
    assert revisions == list(range(revisions[0], -1, -1))


def test_a_stop_does_not_take_along_what_the_guard_refused(met):
    met.controller.change(DEVELOPER, "r2", change(0))
    met.controller.handle_applied("r2", Applied(revision=1))
    met.controller.change(
        DEVELOPER, "r2", change(1, {"drive": {"flows": {"flow1": {"block": True}}}})
    )
    met.controller.handle_applied("r2", Applied(revision=2, error="no"))
    view = met.controller.start_emergency_stop(DEVELOPER, "r2", "fire")
    assert view.settings.nodes == BLOCKED


def test_a_stop_that_is_refused_is_sent_with_what_was_last_applied_then_alone(
    controller_on_each_database,
):
    controller_on_each_database.controller.change(DEVELOPER, "r2", change(0))
    controller_on_each_database.controller.handle_applied("r2", Applied(revision=1))
    controller_on_each_database.controller.change(
        DEVELOPER, "r2", change(1, {"drive": {"flows": {"flow1": {"block": True}}}})
    )
    controller_on_each_database.controller.start_emergency_stop(DEVELOPER, "r2", "fire")
    controller_on_each_database.controller.handle_applied("r2", Applied(revision=3, error="no"))
    view = newest(controller_on_each_database)
    assert (view.revision, view.by, view.settings.nodes) == (4, "rtron", BLOCKED)
    assert view.settings.stop.reason == "fire"
    controller_on_each_database.controller.handle_applied("r2", Applied(revision=4, error="no"))
    assert (
        newest(controller_on_each_database).settings.nodes,
        newest(controller_on_each_database).settings.stop.reason,
    ) == ({}, "fire")
    controller_on_each_database.controller.handle_applied("r2", Applied(revision=5, error="no"))
    assert newest(controller_on_each_database).revision == 5
    assert [settings.revision for _, settings in controller_on_each_database.guards.pushed] == [
        1,
        2,
        3,
        4,
        5,
    ]


class FullDatabase(Database):
    """A database on a disk that is full for as long as `full` says."""

    full = False

    def session(self):
        if self.full:
            raise OperationalError("INSERT", {}, Exception("database or disk is full"))
        return super().session()


def test_a_stop_goes_out_even_if_it_cannot_be_stored(tmp_path):
    world = ControllerSetup(FullDatabase(tmp_path / "rtron.db"))
    world.controller.handle_hello("r2", hello(plan()))
    world.controller.change(DEVELOPER, "r2", change(0))
    world.database.full = True
    with pytest.raises(SourceError, match="sent, but not stored"):
        world.controller.start_emergency_stop(END_USER, "r2", "fire")
    _, sent = world.guards.pushed[-1]
    assert (sent.revision, sent.stop.reason, sent.nodes) == (2, "fire", BLOCKED)
    with pytest.raises(ForbiddenError):
        world.controller.start_emergency_stop(caller(), "r2", "fire")
    world.database.full = False
    sent = world.controller.handle_hello("r2", hello(plan(), revision=2))
    assert (sent.revision, sent.stop.reason, sent.nodes) == (3, "fire", BLOCKED)
    assert (newest(world).settings, newest(world).by) == (sent, "eve")
    view = world.controller.change(DEVELOPER, "r2", change(3, {"drive": {"policy": None}}))
    assert (view.revision, view.settings.stop.reason) == (4, "fire")
    assert release(world, DEVELOPER).settings.stop is None
    assert world.controller.handle_hello("r2", hello(plan())).stop is None
    world.database.full = True
    with pytest.raises(SourceError):
        world.controller.start_emergency_stop(END_USER, "r2", "flood")
    _, sent = world.guards.pushed[-1]
    assert (sent.revision, sent.stop.reason, sent.nodes) == (6, "flood", {})
    world.database.close()


def test_a_stop_that_cannot_be_stored_goes_above_what_the_guard_has(tmp_path):
    """A service that has begun again while the database is away."""
    world = ControllerSetup(FullDatabase(tmp_path / "rtron.db"))
    world.database.full = True
    with pytest.raises(OperationalError):
        world.controller.handle_hello(
            "r2", hello(plan(), settings=Settings(revision=7, nodes=BLOCKED))
        )
    for revision in (8, 9):
        with pytest.raises(SourceError):
            world.controller.start_emergency_stop(END_USER, "r2", "fire")
        _, sent = world.guards.pushed[-1]
        assert (sent.revision, sent.stop.reason, sent.nodes) == (revision, "fire", BLOCKED)
    world.database.full = False
    assert world.controller.handle_hello("r2", hello(plan(), settings=sent)).stop.reason == "fire"
    world.database.close()


@pytest.fixture
def full(tmp_path):
    """A world whose robot is stopped by a stop that could not be stored; there is room again."""
    world = ControllerSetup(FullDatabase(tmp_path / "rtron.db"))
    world.controller.handle_hello("r2", hello(plan()))
    world.database.full = True
    with pytest.raises(SourceError):
        world.controller.start_emergency_stop(END_USER, "r2", "fire")
    world.database.full = False
    yield world
    world.database.close()


def test_no_release_of_a_stop_that_nobody_could_see(full):
    with pytest.raises(StaleRevisionError) as caught:
        release(full, DEVELOPER, 0)
    newer = caught.value.newest
    assert (newer.revision, newer.settings.stop.reason) == (2, "fire")
    assert [settings.revision for _, settings in full.guards.pushed] == [1, 2]


def test_a_change_after_a_stop_that_was_not_stored_sees_it_first(full):
    with pytest.raises(StaleRevisionError):
        full.controller.change(DEVELOPER, "r2", change(0))
    view = full.controller.change(DEVELOPER, "r2", change(2))
    assert (view.revision, view.settings.stop.reason) == (3, "fire")


def test_an_override_takes_along_the_stop_that_was_not_stored(full):
    request = OverrideRequest(duration=60, reason="docking")
    view = full.controller.start_override(END_USER, "r2", "speed", request)
    assert (view.revision, view.settings.stop.reason) == (3, "fire")
    again = full.restarted()
    assert newest(again).settings.stop.reason == "fire"
    again.database.close()


class SlowChannel(RecordingChannel):
    """A hub that lets another person begin before it has sent revision 1."""

    other: Thread

    def push(self, robot, settings):
        if settings.revision == 1:
            self.other.start()
            self.other.join(0.3)
        super().push(robot, settings)


def test_what_is_pushed_never_goes_back(tmp_path):
    """The guard hears the revisions in the order in which they are stored."""
    world = ControllerSetup(Database(tmp_path / "rtron.db"), guards=SlowChannel())
    world.guards.other = Thread(
        target=world.controller.start_emergency_stop, args=(END_USER, "r2", "fire")
    )
    world.controller.handle_hello("r2", hello(plan()))
    world.controller.change(DEVELOPER, "r2", change(0))
    world.guards.other.join()
    assert [settings.revision for _, settings in world.guards.pushed] == [1, 2]
    assert world.guards.pushed[-1][1].stop.reason == "fire"
    world.database.close()


def rejected_block(world):
    """Let the guard refuse revision 2, which blocks a flow; revision 1 is in force."""
    world.controller.change(DEVELOPER, "r2", change(0))
    world.controller.handle_applied("r2", Applied(revision=1))
    flows = {"drive": {"flows": {"flow1": {"block": True}}}}
    world.controller.change(DEVELOPER, "r2", change(1, flows))
    world.controller.handle_applied("r2", Applied(revision=2, error="no"))


def test_an_override_does_not_take_along_what_the_guard_refused(met):
    rejected_block(met)
    request = OverrideRequest(duration=60, reason="docking")
    assert met.controller.start_override(END_USER, "r2", "speed", request).settings.nodes == BLOCKED
    assert nodes(met)[0].policy_settings["flows"][0]["block"] is False


def test_a_change_does_not_take_along_what_the_guard_refused(met):
    rejected_block(met)
    view = met.controller.change(DEVELOPER, "r2", change(2, {"speed": {"threshold": 0.5}}))
    assert view.settings.nodes == {**BLOCKED, "speed": NodeSettings(threshold=0.5)}


def test_what_was_refused_can_be_asked_for_again(met):
    rejected_block(met)
    flows = {"drive": {"flows": {"flow1": {"block": True}}}}
    view = met.controller.change(DEVELOPER, "r2", change(2, flows))
    assert (view.revision, view.settings.nodes["drive"].flows["flow1"].block) == (3, True)


def test_what_the_guard_took_last_is_left_out_where_another_plan_has_it_not(met):
    met.controller.change(DEVELOPER, "r2", change(0))
    met.controller.handle_applied("r2", Applied(revision=1))
    met.controller.handle_hello("r2", hello(plan_with("id: drive", "id: wheels")))
    met.controller.handle_applied("r2", Applied(revision=2, error="no"))
    assert met.controller.start_emergency_stop(DEVELOPER, "r2", "fire").settings.nodes == {}


# The audit log stays small.


def test_the_same_refusal_is_one_line_a_minute(controller_on_each_database):
    controller_on_each_database.clock.now = 90 * SECOND
    for _ in range(50):
        with pytest.raises(ForbiddenError):
            controller_on_each_database.controller.change(ADMIN, "r2", change(0))
    lines = [row for row in audit(controller_on_each_database) if row.who == "root"]
    assert [(row.detail["count"], row.at) for row in lines] == [(50, 90 * SECOND)]
    controller_on_each_database.clock.now += 60 * SECOND
    with pytest.raises(ForbiddenError):
        controller_on_each_database.controller.change(ADMIN, "r2", change(0))
    assert "count" not in audit(controller_on_each_database)[-1].detail


def test_other_refusals_are_lines_of_their_own_up_to_20(met):
    request = OverrideRequest(duration=1, reason="docking")
    for number in range(50):
        with pytest.raises(NotFoundError):
            met.controller.start_override(DEVELOPER, "r2", f"node{number}", request)
    lines = [row for row in audit(met) if row.who == "dev"]
    assert [row.detail.get("count", 1) for row in lines] == [1] * 19 + [31]


def test_what_a_guard_says_again_and_again_is_counted(met):
    for number in range(50):
        met.controller.handle_applied("r2", Applied(revision=0, error=f"no {number}"))
        met.controller.handle_applied("r2", Applied(revision=0))
        met.controller.handle_applied("r2", Applied(revision=7 + number))
    lines = [row for row in audit(met) if row.action == "settings.answer"]
    assert [(row.outcome, row.detail["count"]) for row in lines] == [
        ("refused", 50),
        ("applied", 50),
    ]


def test_what_changes_nothing_is_counted(met):
    met.controller.start_emergency_stop(DEVELOPER, "r2", "fire")
    met.controller.handle_applied("r2", Applied(revision=1))
    for _ in range(50):
        met.controller.start_emergency_stop(DEVELOPER, "r2", "fire")
    assert [row.detail.get("count") for row in audit(met) if row.action == "stop"] == [51]


def test_no_secret_and_no_number_of_the_database_in_errors(met):
    with pytest.raises(ConflictError) as caught:
        met.controller.change(DEVELOPER, "r2", change(5))
    assert re.fullmatch(r"the settings are at revision 0, made by rtron", str(caught.value))


def test_flows_settings_are_told_in_the_risk_model(met):
    flows = {"drive": {"flows": {"flow1": {"block": True}}}}
    view = met.controller.change(DEVELOPER, "r2", change(0, flows))
    assert view.settings.nodes["drive"].flows == {"flow1": FlowSettings(block=True)}
    assert nodes(met)[0].policy_settings["flows"][0]["block"] is True


WHOLE = [
    ("drive", {"flows": {"flow1": None}}, DEVELOPER, END_USER),
    ("drive", {"flows": None}, DEVELOPER, END_USER),
    ("speed", {"flows": {"vflow1": None}}, DEVELOPER, END_USER),
    ("mission", {"flows": {"aflow1": None}}, END_USER, DEVELOPER),
    ("mission", {"rules": {"watched": None}}, END_USER, DEVELOPER),
    ("mission", {"rules": None}, END_USER, DEVELOPER),
]


@pytest.mark.parametrize(("node", "patch", "who_may", "who_may_not"), WHOLE)
def test_null_for_a_whole_flow_or_rule_takes_a_right_where_nothing_is_set_too(
    met, node, patch, who_may, who_may_not
):
    with pytest.raises(ForbiddenError):
        met.controller.change(who_may_not, "r2", change(0, {node: patch}))
    assert met.controller.change(who_may, "r2", change(0, {node: patch})).revision == 0


def test_null_for_the_rules_of_a_node_that_has_none_is_nobodys(met):
    for who in (DEVELOPER_AND_END_USER, ADMIN):
        with pytest.raises(ForbiddenError):
            met.controller.change(who, "r2", change(0, {"drive": {"rules": None}}))
