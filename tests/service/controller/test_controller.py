"""The risk controller on a real database: revisions, rights, the audit log, the stop."""

import re
from contextlib import suppress
from dataclasses import replace
from threading import Barrier, Thread

import pytest
from controller_plans import (
    ADMIN,
    BOTH,
    DEVELOPER,
    END_USER,
    World,
    caller,
    hello,
    plan,
    swapped,
)
from sqlalchemy import select
from sqlalchemy.exc import OperationalError

from rtron.errors import InputError, SourceError, WireError
from rtron.service.api.models import OverrideRequest, SettingsChange, SettingsOutcome
from rtron.service.controller.changing import RevisionError
from rtron.service.controller.known import find_known
from rtron.service.errors import ConflictError, ForbiddenError, NotFoundError
from rtron.service.store.database import Database
from rtron.service.store.robots import coordination_nodes
from rtron.service.store.settings_rows import history, settings_view
from rtron.service.store.tables import AuditRow
from rtron.vocabulary import (
    SECOND,
    EmergencyStop,
    FlowSettings,
    NodeSettings,
    PolicyName,
    Settings,
    TimedOverride,
)
from rtron.wire.link import Applied

BLOCK = {"drive": {"policy": "Block"}}
BLOCKED = {"drive": NodeSettings(policy=PolicyName.BLOCK)}


def change(revision, nodes=None, reason="why"):
    return SettingsChange(revision=revision, nodes=nodes or BLOCK, reason=reason)


def audit(world):
    with world.database.session() as session:
        return list(session.scalars(select(AuditRow).order_by(AuditRow.id)))


def deeds(world):
    return [(row.who, row.action, row.outcome) for row in audit(world)]


def newest(world, robot="r2"):
    with world.database.session() as session:
        return settings_view(find_known(session, robot).row)


def views(world, robot="r2"):
    with world.database.session() as session:
        app = find_known(session, robot).app
        return [settings_view(row) for row in history(session, app.id, None, 100)]


def nodes(world):
    with world.database.session() as session:
        return list(coordination_nodes(session, find_known(session, "r2").app.id))


def test_a_first_hello_is_revision_0(world):
    assert world.controller.greet("r2", hello(plan())) == Settings()
    view = newest(world)
    assert (view.revision, view.outcome, view.by) == (0, SettingsOutcome.PENDING, "rtron")
    assert [told["type"] for told in world.guards.told] == ["settings"]
    assert deeds(world) == [("guard:r2", "plan", "done"), ("guard:r2", "settings", "done")][::-1]


def test_a_hello_again_changes_nothing(met):
    before = deeds(met)
    assert met.controller.greet("r2", hello(plan())) == Settings()
    assert len(views(met)) == 1
    assert deeds(met) == before


def test_a_dry_run_is_noted_once_for_each_life_of_a_guard(met):
    for run in ("r1", "r1", "r2", "r2"):
        met.controller.greet("r2", replace(hello(plan(), dry_run=True), run=run))
    assert [row.action for row in audit(met)].count("dry_run") == 2


def test_the_risk_model_of_each_node_is_kept(anywhere):
    found = {row.node: row for row in nodes(anywhere)}
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


def test_a_change_is_stored_sent_and_told(anywhere):
    anywhere.clock.now = 77
    view = anywhere.controller.change(DEVELOPER, "r2", change(0))
    assert (view.revision, view.by, view.reason, view.at) == (1, "dev", "why", 77)
    assert view.settings.nodes == BLOCKED
    assert anywhere.guards.pushed == [("r2", Settings(revision=1, nodes=BLOCKED))]
    assert anywhere.guards.told[-1]["view"] == view.model_dump(mode="json")
    assert newest(anywhere) == view
    assert nodes(anywhere)[0].policy_settings["policy"] == "Block"
    assert audit(anywhere)[-1].detail == {
        "revision": 0,
        "nodes": '{"drive": {"policy": "Block"}}',
        "reason": "why",
    }
    assert audit(anywhere)[-1].address == "10.0.0.7"


def test_it_is_in_the_database_before_the_guard_hears_of_it(met):
    seen = []
    met.guards.push = lambda robot, settings: seen.append((settings.revision, newest(met).revision))
    met.controller.change(DEVELOPER, "r2", change(0))
    met.controller.stop(DEVELOPER, "r2", "fire")
    assert seen == [(1, 1), (2, 2)]


def test_what_was_answered_is_there_after_a_restart(anywhere):
    view = anywhere.controller.change(DEVELOPER, "r2", change(0))
    again = anywhere.again()
    assert again.controller.greet("r2", hello(plan())) == view.settings
    again.database.close()


@pytest.mark.parametrize("revision", [0, 2, 99])
def test_a_change_of_another_revision_is_overtaken(met, revision):
    view = met.controller.change(DEVELOPER, "r2", change(0))
    with pytest.raises(RevisionError) as caught:
        met.controller.change(DEVELOPER, "r2", change(revision, {"drive": {"policy": None}}))
    assert caught.value.newest == view
    assert len(met.guards.pushed) == 1
    assert deeds(met)[-1] == ("dev", "settings", f"refused: {caught.value}")


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
        (BOTH, {"mission": {"flows": {"aflow1": {"priority": 3}}}}, "set_priority at mission"),
    ],
)
def test_who_lacks_the_right_is_refused_and_noted(met, who, nodes, missing):
    with pytest.raises(ForbiddenError, match=f"may not {missing}$"):
        met.controller.change(who, "r2", change(0, nodes))
    assert deeds(met)[-1][0] == who.name
    assert deeds(met)[-1][2].startswith("refused: ")
    assert (newest(met).revision, met.guards.pushed) == (0, [])


def test_what_is_mandatory_stays(met):
    off = {"mission": {"rules": {"quiet": {"selected": False}}}}
    with pytest.raises(ForbiddenError, match="quiet of mission is mandatory"):
        met.controller.change(BOTH, "r2", change(0, off))


def test_what_makes_no_plan_is_refused(met):
    same = {"drive": {"flows": {"flow1": {"priority": 1}}}}
    with pytest.raises(InputError, match="the same priority"):
        met.controller.change(DEVELOPER, "r2", change(0, same))
    assert deeds(met)[-1][2].startswith("refused: flow1 and flow2")


@pytest.mark.parametrize(("robot", "told"), [("r3", "no such robot"), ("", "no such robot")])
def test_an_unknown_robot(met, robot, told):
    with pytest.raises(NotFoundError, match=told):
        met.controller.change(DEVELOPER, robot, change(0))
    with pytest.raises(NotFoundError, match=told):
        met.controller.stop(DEVELOPER, robot, "")


def test_long_changes_are_cut_in_the_audit_log(anywhere):
    nodes = {"drive": {"flows": {f"flow{i}": {"priority": i} for i in range(1000)}}}
    with pytest.raises(InputError):
        anywhere.controller.change(DEVELOPER, "r2", change(0, nodes))
    assert len(audit(anywhere)[-1].detail["nodes"]) == 2000


def test_of_two_changes_at_once_one_is_overtaken(anywhere):
    both, outcomes = Barrier(2), []

    def ask(limit):
        both.wait()
        try:
            anywhere.controller.change(
                END_USER, "r2", change(0, {"speed": {"max_vel_limit": limit}})
            )
            outcomes.append(limit)
        except RevisionError:
            outcomes.append(None)

    threads = [Thread(target=ask, args=(limit,)) for limit in (0.1, 0.2)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    (won,) = filter(None, outcomes)
    assert newest(anywhere).settings.nodes["speed"].max_vel_limit == won
    assert newest(anywhere).revision == 1


# What the guard says.


def test_what_the_guard_applies_is_applied_and_older_ones_are_replaced(anywhere):
    anywhere.controller.change(DEVELOPER, "r2", change(0))
    anywhere.controller.change(DEVELOPER, "r2", change(1, {"drive": {"policy": None}}))
    anywhere.clock.now = 99
    anywhere.controller.answered("r2", Applied(revision=2))
    assert [view.outcome for view in views(anywhere)] == ["applied", "replaced", "replaced"]
    assert {view.answered for view in views(anywhere)} == {99}
    assert anywhere.guards.told[-1]["view"]["outcome"] == "applied"
    assert deeds(anywhere)[-1] == ("guard:r2", "settings.answer", "applied")


def test_an_answer_that_is_said_again_is_noted_once(met):
    met.controller.answered("r2", Applied(revision=0))
    before, told = deeds(met), len(met.guards.told)
    met.controller.answered("r2", Applied(revision=0))
    assert (deeds(met), len(met.guards.told)) == (before, told)


def test_refused_settings_stay_refused_and_go_out_with_the_next_hello(met):
    met.controller.change(DEVELOPER, "r2", change(0))
    met.controller.answered("r2", Applied(revision=1, error="no such flow" + "w" * 2000))
    view = newest(met)
    assert (view.outcome, view.error[:12], len(view.error)) == ("refused", "no such flow", 1000)
    assert met.controller.greet("r2", hello(plan())).revision == 1
    assert newest(met).outcome == "refused"
    assert len(met.guards.pushed) == 1


def test_settings_that_were_refused_can_be_applied_later(met):
    met.controller.answered("r2", Applied(revision=0, error="busy"))
    met.controller.answered("r2", Applied(revision=0))
    assert (newest(met).outcome, newest(met).error) == ("applied", "")


def test_an_answer_to_nothing_is_ignored(met, caplog):
    met.controller.answered("r2", Applied(revision=7))
    assert "answers revision 7" in caplog.text
    assert len(views(met)) == 1


# Hello under another plan.


def test_settings_that_no_longer_fit_are_left_out_as_a_new_revision(anywhere):
    two = {**BLOCK, "speed": {"threshold": 0.5}}
    anywhere.controller.change(DEVELOPER, "r2", change(0, two))
    sent = anywhere.controller.greet("r2", hello(swapped("id: drive", "id: wheels"), revision=1))
    assert sent == Settings(revision=2, nodes={"speed": NodeSettings(threshold=0.5)})
    assert newest(anywhere).reason.startswith(
        "the plan has changed, left out: no coordination node"
    )
    assert [row.node for row in nodes(anywhere)] == ["wheels", "speed", "mission", "eyes"]
    assert anywhere.controller.greet("r2", hello(swapped("id: drive", "id: wheels"))).revision == 2


def test_settings_that_fit_go_on_under_a_new_plan(met):
    met.controller.change(DEVELOPER, "r2", change(0))
    sent = met.controller.greet("r2", hello(swapped("priority: 2", "priority: 3")))
    assert sent == Settings(revision=1, nodes=BLOCKED)


def test_an_emergency_stop_goes_on_under_a_new_plan(met):
    met.controller.stop(DEVELOPER, "r2", "fire")
    sent = met.controller.greet("r2", hello(swapped("id: drive", "id: wheels")))
    assert sent.stop.reason == "fire"


def test_a_guard_with_newer_settings_is_never_asked_to_go_back(met):
    assert met.controller.greet("r2", hello(plan(), revision=41)).revision == 42
    assert newest(met).reason == "the guard had revision 41, which was not in the database"


def test_what_the_database_has_lost_is_taken_over_from_the_guard(met):
    stop = EmergencyStop(by="ann", reason="fire", at=7)
    lost = NodeSettings(policy=PolicyName.PREEMPTION)
    theirs = Settings(revision=9, nodes={**BLOCKED, "wheels": lost}, stop=stop)
    sent = met.controller.greet("r2", hello(plan(), settings=theirs))
    assert sent == Settings(revision=10, nodes=BLOCKED, stop=stop)
    assert newest(met).settings == sent


def test_what_the_database_has_is_not_taken_from_the_guard(met):
    theirs = Settings(revision=0, nodes=BLOCKED)
    assert met.controller.greet("r2", hello(plan(), settings=theirs)).nodes == {}


def test_each_app_has_settings_of_its_own(met):
    met.controller.change(DEVELOPER, "r2", change(0))
    assert met.controller.greet("r2", hello(plan(), app="other")) == Settings()
    assert met.controller.greet("r2", hello(plan())).revision == 1


def test_an_override_that_is_over_does_not_go_out(met):
    request = OverrideRequest(duration=2, reason="docking")
    met.clock.now = 10 * SECOND
    met.controller.override(END_USER, "r2", "speed", request)
    met.clock.now = 12 * SECOND - 1
    assert list(met.controller.greet("r2", hello(plan())).overrides) == ["speed"]
    met.clock.now = 12 * SECOND
    assert met.controller.greet("r2", hello(plan())) == Settings(revision=1)
    met.controller.change(DEVELOPER, "r2", change(1))
    assert newest(met).settings.overrides == {}


@pytest.mark.parametrize(
    "odd",
    [
        hello(replace(plan(), grcn=(replace(plan().grcn[0], id="a b"),))),
        hello(replace(plan(), grcn=(plan().grcn[0],) * 2)),
        hello(replace(plan(), grcn=(replace(plan().grcn[0], id="a" * 201),))),
        hello(plan(), app="a" * 201),
        hello(plan(), revision=-1),
        hello(plan(), revision=1 << 50),
    ],
)
def test_a_hello_that_no_guard_says_is_refused(world, odd):
    with pytest.raises(WireError):
        world.controller.greet("r2", odd)
    with pytest.raises(NotFoundError):
        newest(world)


def test_the_apps_of_a_robot_are_counted(world):
    for number in range(100):
        world.controller.greet("r2", hello(plan(), app=f"app{number}"))
    with pytest.raises(InputError, match="100 apps"):
        world.controller.greet("r2", hello(plan(), app="one more"))
    world.controller.greet("r2", hello(plan(), app="app7"))


# Overrides.


@pytest.mark.parametrize("who", [DEVELOPER, END_USER])
@pytest.mark.parametrize("node", ["speed", "mission"])
def test_both_may_override_for_a_while(met, who, node):
    request = OverrideRequest(duration=0.5, reason="docking")
    view = met.controller.override(who, "r2", node, request)
    until = met.clock.now + SECOND // 2
    assert view.settings.overrides == {
        node: TimedOverride(by=who.name, reason="docking", until=until)
    }
    assert met.controller.end_override(who, "r2", node).settings.overrides == {}
    assert [settings.revision for _, settings in met.guards.pushed] == [1, 2]


@pytest.mark.parametrize(
    ("who", "node", "error"),
    [
        (DEVELOPER, "drive", ForbiddenError),
        (BOTH, "drive", ForbiddenError),
        (ADMIN, "speed", ForbiddenError),
        (caller(), "speed", ForbiddenError),
        (DEVELOPER, "eyes", NotFoundError),
        (DEVELOPER, "spead", NotFoundError),
    ],
)
def test_nobody_else_and_nothing_else(met, who, node, error):
    request = OverrideRequest(duration=0.5, reason="docking")
    with pytest.raises(error):
        met.controller.override(who, "r2", node, request)
    with pytest.raises(error):
        met.controller.end_override(who, "r2", node)
    assert met.guards.pushed == []


def test_what_is_not_overridden_has_no_end(met):
    with pytest.raises(NotFoundError, match="speed is not overridden"):
        met.controller.end_override(DEVELOPER, "r2", "speed")


# The emergency stop.


@pytest.mark.parametrize("who", [DEVELOPER, END_USER, ADMIN])
def test_every_role_may_stop_and_release(met, who):
    met.clock.now = 5
    stop = EmergencyStop(by=who.name, reason="fire", at=5)
    view = met.controller.stop(who, "r2", "fire")
    assert (view.revision, view.settings) == (1, Settings(revision=1, stop=stop))
    assert met.guards.pushed == [("r2", Settings(revision=1, stop=stop))]
    view = met.controller.release(who, "r2", "all clear")
    assert (view.revision, view.settings.stop) == (2, None)
    assert [row.action for row in audit(met)[-2:]] == ["stop", "stop.end"]


def test_a_token_without_a_role_may_not(met):
    with pytest.raises(ForbiddenError):
        met.controller.stop(caller(), "r2", "")
    met.controller.stop(END_USER, "r2", "")
    with pytest.raises(ForbiddenError):
        met.controller.release(caller(), "r2", "all clear")


def test_a_second_stop_goes_out_while_the_first_is_not_confirmed(met):
    first = met.controller.stop(DEVELOPER, "r2", "fire")
    second = met.controller.stop(END_USER, "r2", "me too")
    assert (second.revision, second.settings.stop) == (2, first.settings.stop)
    assert met.guards.pushed == [("r2", first.settings), ("r2", second.settings)]
    met.controller.answered("r2", Applied(revision=2))
    assert met.controller.stop(END_USER, "r2", "me too").revision == 2
    assert len(met.guards.pushed) == 2
    assert deeds(met)[-1] == ("eve", "stop", "done")


@pytest.mark.parametrize("reason", ["", "ok", "  "])
def test_the_end_needs_a_reason(met, reason):
    met.controller.stop(DEVELOPER, "r2", "")
    with pytest.raises(InputError, match="needs a reason"):
        met.controller.release(DEVELOPER, "r2", reason)
    assert newest(met).settings.stop


def test_nothing_to_release(met):
    with pytest.raises(NotFoundError, match="not stopped"):
        met.controller.release(DEVELOPER, "r2", "all clear")


def test_settings_can_change_while_stopped_and_the_stop_stays(met):
    met.controller.stop(DEVELOPER, "r2", "fire")
    view = met.controller.change(DEVELOPER, "r2", change(1))
    assert (view.settings.stop.reason, view.settings.nodes) == ("fire", BLOCKED)


def test_a_stop_is_never_overtaken(anywhere):
    """Many change settings; each stop goes on top of the newest all the same."""
    done, errors = Barrier(5), []

    def stop_and_release():
        done.wait()
        try:
            for _ in range(10):
                anywhere.controller.stop(END_USER, "r2", "")
                with suppress(NotFoundError):
                    anywhere.controller.release(END_USER, "r2", "all clear")
        except Exception as error:  # noqa: BLE001 - told below
            errors.append(error)

    threads = [Thread(target=stop_and_release) for _ in range(5)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert errors == []
    anywhere.controller.stop(END_USER, "r2", "")
    revisions = [view.revision for view in views(anywhere)]
    assert revisions == list(range(revisions[0], -1, -1))


def test_a_stop_does_not_take_along_what_the_guard_refused(met):
    met.controller.change(DEVELOPER, "r2", change(0))
    met.controller.answered("r2", Applied(revision=1))
    met.controller.change(
        DEVELOPER, "r2", change(1, {"drive": {"flows": {"flow1": {"block": True}}}})
    )
    met.controller.answered("r2", Applied(revision=2, error="no"))
    view = met.controller.stop(DEVELOPER, "r2", "fire")
    assert view.settings.nodes == BLOCKED


def test_a_stop_that_is_refused_is_sent_with_what_was_last_applied_then_alone(anywhere):
    anywhere.controller.change(DEVELOPER, "r2", change(0))
    anywhere.controller.answered("r2", Applied(revision=1))
    anywhere.controller.change(
        DEVELOPER, "r2", change(1, {"drive": {"flows": {"flow1": {"block": True}}}})
    )
    anywhere.controller.stop(DEVELOPER, "r2", "fire")
    anywhere.controller.answered("r2", Applied(revision=3, error="no"))
    view = newest(anywhere)
    assert (view.revision, view.by, view.settings.nodes) == (4, "rtron", BLOCKED)
    assert view.settings.stop.reason == "fire"
    anywhere.controller.answered("r2", Applied(revision=4, error="no"))
    assert (newest(anywhere).settings.nodes, newest(anywhere).settings.stop.reason) == ({}, "fire")
    anywhere.controller.answered("r2", Applied(revision=5, error="no"))
    assert newest(anywhere).revision == 5
    assert [settings.revision for _, settings in anywhere.guards.pushed] == [1, 2, 3, 4, 5]


class Full(Database):
    """A database on a disk that is full for as long as `full` says."""

    full = False

    def session(self):
        if self.full:
            raise OperationalError("INSERT", {}, Exception("database or disk is full"))
        return super().session()


def test_a_stop_goes_out_even_if_it_cannot_be_stored(tmp_path):
    world = World(Full(tmp_path / "rtron.db"))
    world.controller.greet("r2", hello(plan()))
    world.controller.change(DEVELOPER, "r2", change(0))
    world.database.full = True
    with pytest.raises(SourceError, match="sent, but not stored"):
        world.controller.stop(END_USER, "r2", "fire")
    _, sent = world.guards.pushed[-1]
    assert (sent.revision, sent.stop.reason, sent.nodes) == (2, "fire", BLOCKED)
    with pytest.raises(ForbiddenError):
        world.controller.stop(caller(), "r2", "fire")
    world.database.full = False
    assert world.controller.greet("r2", hello(plan(), revision=1)).stop.reason == "fire"
    view = world.controller.change(DEVELOPER, "r2", change(1, {"drive": {"policy": None}}))
    assert (view.revision, view.settings.stop.reason) == (3, "fire")
    assert world.controller.release(DEVELOPER, "r2", "all clear").settings.stop is None
    assert world.controller.greet("r2", hello(plan())).stop is None
    world.database.full = True
    with pytest.raises(SourceError):
        world.controller.stop(END_USER, "r2", "flood")
    _, sent = world.guards.pushed[-1]
    assert (sent.revision, sent.stop.reason, sent.nodes) == (5, "flood", {})
    world.database.close()


def test_no_secret_and_no_number_of_the_database_in_errors(met):
    with pytest.raises(ConflictError) as caught:
        met.controller.change(DEVELOPER, "r2", change(5))
    assert re.fullmatch(r"the settings are at revision 0, made by rtron", str(caught.value))


def test_flows_settings_are_told_in_the_risk_model(met):
    flows = {"drive": {"flows": {"flow1": {"block": True}}}}
    view = met.controller.change(DEVELOPER, "r2", change(0, flows))
    assert view.settings.nodes["drive"].flows == {"flow1": FlowSettings(block=True)}
    assert nodes(met)[0].policy_settings["flows"][0]["block"] is True
