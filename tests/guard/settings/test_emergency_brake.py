"""The emergency stop and the overrides of settings: in force at once, over in time."""

from dataclasses import replace

import pytest
from settings_app import GENERAL, PLAN, WALL, Base, flow, limit, of
from streams import peer

from rtron.guard.settings.local_overrides import MAX_DURATION, OverrideCommands
from rtron.vocabulary import (
    SECOND,
    EmergencyStop,
    Mode,
    PolicyName,
    Settings,
    StopProfile,
    TimedOverride,
)

STOP = Settings(revision=2, stop=EmergencyStop(by="ann", reason="a child\nis there", at=WALL))
WHY = "emergency stop by ann: a child is there"
GO = Settings(revision=3)


@pytest.fixture
def base():
    return Base()


def test_the_base_is_ramped_down_and_told_to_rest_until_it_is_released(base):
    base.drive(1.0)
    base.apply(STOP)
    assert base.applying.is_stopped
    base.transport.advance(5 * SECOND)
    xs = base.xs()
    assert xs[:3] == [1.0, 0.875, 0.75]
    assert xs == sorted(xs, reverse=True)
    base.drive(1.0)
    base.drive(1.0, "teleop")
    base.transport.advance(SECOND // 20)
    assert set(base.xs()[len(xs) :]) == {0.0}
    assert base.tally("flow1").last.reason == WHY
    base.apply(GO)
    assert not base.applying.is_stopped
    base.drive(0.7)
    assert base.xs()[-1] == 0.7


def test_after_the_release_the_stop_ends_and_then_there_is_silence(base):
    base.apply(STOP)
    base.transport.advance(5 * SECOND)
    base.apply(GO)
    base.transport.advance(2 * SECOND)
    told = len(base.driver)
    base.transport.advance(5 * SECOND)
    assert len(base.driver) == told
    assert set(base.xs()) == {0.0}


def test_a_base_that_nobody_has_moved_yet_is_told_to_rest(base):
    assert base.driver == []
    base.apply(STOP)
    base.transport.advance(SECOND)
    assert set(base.xs()) == {0.0}


def test_a_stop_while_a_stop_goes_on_does_not_set_the_base_in_motion_again(base):
    base.drive(1.0)
    base.apply(flow("flow1", block=True))
    base.transport.advance(SECOND // 5)
    assert base.stream().stop_controller.reason == "flow1 is blocked"
    base.apply(replace(STOP, revision=3))
    assert base.stream().stop_controller.reason == WHY
    base.transport.advance(SECOND)
    base.apply(replace(STOP, revision=4))
    base.apply(replace(STOP, revision=5, stop=replace(STOP.stop, by="bob")))
    base.transport.advance(SECOND)
    xs = base.xs()
    assert xs == sorted(xs, reverse=True)
    assert base.stream().stop_controller.stop_count == 1
    assert base.stream().stop_controller.reason == "emergency stop by bob: a child is there"


def test_other_settings_change_while_the_stop_stays(base):
    base.drive(1.0)
    base.apply(STOP)
    base.apply(replace(STOP, revision=3, nodes=flow("flow2", priority=7).nodes))
    base.drive(1.0, "teleop")
    base.transport.advance(SECOND)
    xs = base.xs()
    assert xs == sorted(xs, reverse=True)
    assert base.stream().brake_reason == WHY


def test_what_another_has_braked_stays_braked(base):
    base.drive(1.0)
    base.stream().brake("the audit", "a stranger")
    base.apply(STOP)
    assert base.stream().stop_controller.reason == WHY
    base.apply(GO)
    assert base.stream().stop_controller.reason == "a stranger"
    base.transport.advance(3 * SECOND)
    base.drive(1.0)
    base.transport.advance(SECOND)
    assert base.xs()[-1] == 0.0
    base.stream().release("the audit")
    base.drive(0.5)
    assert base.xs()[-1] == 0.5


def test_what_another_releases_stays_stopped(base):
    base.apply(STOP)
    base.stream().brake("the audit", "a stranger")
    base.stream().release("the audit")
    base.drive(1.0)
    base.transport.advance(SECOND)
    assert set(base.xs()) == {0.0}
    assert base.stream().stop_controller.reason == WHY


def test_states_and_what_only_observes_go_on():
    base = Base(replace(PLAN, grcn=(replace(GENERAL, mode=Mode.OBSERVE), PLAN.grcn[1])))
    base.apply(STOP)
    braked = {
        (each.spec.topic, each.spec.mode): bool(each.brake_reason) for each in base.host.streams
    }
    assert braked == {
        ("/cmd_vel", Mode.OBSERVE): False,
        ("/cmd_vel", Mode.ENFORCE): True,
        ("/map", Mode.ENFORCE): False,
        ("/max_vel", Mode.ENFORCE): True,
    }


def test_a_dry_run_only_tells_so(caplog):
    base = Base(dry_run=True)
    base.apply(STOP)
    assert not base.applying.is_stopped
    base.drive(1.0)
    assert base.xs() == [1.0]
    assert WHY in caplog.messages
    told = [s.message for s in base.host.statuses() if s.name == "rtron: emergency stop"]
    assert told == [f"{WHY} (dry run, nothing is stopped)"]
    base.apply(GO)
    assert f"released: {WHY}" in caplog.messages
    assert not [s for s in base.host.statuses() if s.name == "rtron: emergency stop"]


def test_the_diagnostics_tell_the_stop(base):
    base.apply(STOP)
    told = {s.name: s.message for s in base.host.statuses()}
    assert told["rtron: emergency stop"] == WHY
    assert told["rtron: /cmd_vel (grcn, msrcn, rsrcn)"] == f"stopping: {WHY}"


def test_a_guard_that_begins_under_a_stop_tells_the_base_to_rest():
    base = Base(opened=False)
    base.apply(STOP)
    assert base.driver == []
    base.open()
    base.transport.advance(SECOND)
    assert base.driver
    base.drive(1.0)
    base.transport.advance(SECOND)
    assert set(base.xs()) == {0.0}
    base.apply(GO)
    base.drive(0.5)
    assert base.xs()[-1] == 0.5


def test_a_stop_that_is_released_before_the_guard_opens_stops_nothing():
    base = Base(opened=False)
    base.apply(STOP)
    base.apply(GO)
    base.open()
    base.transport.advance(SECOND)
    assert base.driver == []


def test_a_limit_that_was_lowered_during_the_stop_holds_afterwards(base):
    base.ask(2.0)
    base.apply(STOP)
    base.apply(replace(STOP, revision=3, nodes=limit(0.5).nodes))
    base.transport.advance(SECOND)
    assert base.asked() == [2.0]
    base.apply(replace(limit(0.5), revision=4))
    assert base.asked() == [2.0, 0.5]


def test_a_ramp_is_as_steep_as_the_plan_says():
    base = Base(replace(PLAN, stop=StopProfile(decel=1.0, period=SECOND // 10)))
    base.drive(1.0)
    base.apply(STOP)
    base.transport.advance(SECOND // 2)
    assert base.xs()[:3] == [1.0, 0.9, 0.8]


def over(id, until, by="ann", reason="docking", revision=2, **nodes):
    override = TimedOverride(by=by, reason=reason, until=until)
    return Settings(revision=revision, overrides={id: override}, nodes=nodes)


@pytest.fixture
def limited():
    base = Base()
    base.apply(limit(0.5))
    return base, limit(0.5).nodes


def test_an_override_lasts_until_its_wall_clock_end(limited, caplog):
    base, nodes = limited
    base.apply(over("rsrcn", WALL + SECOND, reason="dock\ning", **nodes))
    base.drive(2.0)
    base.transport.advance(SECOND - 1)
    base.drive(2.0)
    told = base.tally("flow1").last.reason
    assert told == "overridden by ann (dock ing): limited to 0.5 m/s (max_vel_limit)"
    base.transport.advance(1)
    base.drive(2.0)
    assert base.xs() == [2.0, 2.0, 0.5, 0.5]
    assert "rsrcn: overridden by ann for 1.0 s: dock ing" in caplog.messages


@pytest.mark.parametrize("until", [0, WALL - 1, WALL])
def test_an_override_that_has_ended_already_counts_for_nothing(limited, until):
    base, nodes = limited
    base.apply(over("rsrcn", until, **nodes))
    base.drive(2.0)
    assert base.xs() == [0.5]


def test_an_override_that_is_taken_back_ends_at_once(limited):
    base, nodes = limited
    base.ask(2.0)
    base.apply(over("rsrcn", WALL + 60 * SECOND, **nodes))
    base.drive(2.0)
    base.ask(3.0)
    base.apply(Settings(revision=3, nodes=nodes))
    assert base.xs() == [2.0, 0.5]
    assert base.asked() == [0.5, 3.0, 0.5]


def test_an_override_is_as_long_as_settings_say_last(limited):
    base, nodes = limited
    base.apply(over("rsrcn", WALL + SECOND, **nodes))
    base.apply(over("rsrcn", WALL + 5 * SECOND, revision=3, **nodes))
    base.transport.advance(5 * SECOND - 1)
    base.drive(2.0)
    base.apply(over("rsrcn", WALL + 6 * SECOND, revision=4, **nodes), WALL + 7 * SECOND)
    assert base.xs() == [2.0, 0.5]


def test_no_override_lasts_longer_than_one_that_is_asked_for_on_the_robot(limited):
    base, nodes = limited
    base.apply(over("rsrcn", 2**63 - 1, **nodes))
    base.transport.advance(MAX_DURATION - 1)
    base.drive(2.0)
    base.transport.advance(1)
    assert base.xs() == [2.0, 0.5]


def test_an_override_outlasts_another_change(limited):
    base, _ = limited
    base.apply(over("rsrcn", WALL + SECOND, **limit(0.4).nodes))
    base.apply(over("rsrcn", WALL + SECOND, revision=3, **limit(0.3).nodes))
    base.drive(2.0)
    base.transport.advance(SECOND)
    assert base.xs() == [2.0, 0.3]


def asked(duration, reason="by hand"):
    return {"override": "rsrcn", "duration": duration, "reason": reason}


def test_an_override_on_the_robot_stands_beside_that_of_the_settings(limited):
    base, nodes = limited
    local = OverrideCommands(base.host, base.transport)
    local.handle("bob", asked(SECOND))
    base.apply(over("rsrcn", WALL + 2 * SECOND, **nodes))
    base.transport.advance(SECOND)
    base.drive(2.0)
    assert "overridden by ann" in base.tally("flow1").last.reason
    local.handle("bob", asked(9 * SECOND))
    base.apply(Settings(revision=3, nodes=nodes))
    base.drive(2.0)
    assert "overridden by bob" in base.tally("flow1").last.reason
    local.handle("bob", asked(0, reason=""))
    base.transport.advance(0)
    assert base.xs() == [2.0, 2.0, 0.5]


def test_ending_the_override_on_the_robot_leaves_that_of_the_settings(limited):
    base, nodes = limited
    local = OverrideCommands(base.host, base.transport)
    base.apply(over("rsrcn", WALL + 2 * SECOND, **nodes))
    local.handle("bob", asked(9 * SECOND))
    local.handle("bob", asked(0, reason=""))
    base.drive(2.0)
    base.transport.advance(2 * SECOND)
    assert base.xs() == [2.0, 0.5]


def test_an_override_of_the_mission_lets_pass_what_a_rule_forbids(base):
    base.event("red")
    base.apply(over("msrcn", WALL + SECOND))
    base.drive(1.0)
    base.transport.advance(2 * SECOND)
    assert base.xs()[0] == 1.0
    assert base.xs()[-1] == 0.0


def test_nobody_overrides_the_emergency_stop_and_who_is_not_approved(base):
    base.apply(replace(STOP, overrides=over("rsrcn", WALL + SECOND).overrides))
    base.drive(1.0)
    base.transport.publisher("/cmd_vel", peer("/rogue"))
    assert set(base.xs()) == {0.0}


def test_an_override_before_the_guard_opens_counts():
    base = Base(opened=False)
    base.apply(over("rsrcn", WALL + SECOND, **limit(0.5).nodes))
    base.open()
    base.drive(2.0)
    base.transport.advance(SECOND)
    assert base.xs() == [2.0, 0.5]


def test_a_policy_that_has_changed_is_overridden_all_the_same(base):
    base.apply(over("rsrcn", WALL + SECOND, **of("rsrcn", policy=PolicyName.BLOCK).nodes))
    base.apply(over("rsrcn", WALL + SECOND, revision=3, **limit(0.5).nodes))
    base.drive(2.0)
    assert base.xs() == [2.0]
