"""Another plan for the next guard: taken once, kept if it serves, given up if it does not."""

import os
import pickle
from dataclasses import replace

import pytest

from rtron.guard.link.options import LinkOptions
from rtron.guard.link.plan_folder import PlanFolder
from rtron.guard.supervision.fork_server import START_FAILED
from rtron.guard.supervision.guard_config import GuardConfig
from rtron.guard.supervision.plan_trial import (
    PLAN_TRIAL,
    PREPARE_TIMEOUT,
    PlanSlot,
    PlanTrial,
    make_plan_slot,
)
from rtron.guard.supervision.supervisor_fsm import GuardObservation, GuardPhase, SupervisorFsm
from rtron.guard.system.sealed_memory import write_memory_file
from rtron.vocabulary import Plan, Supervision
from rtron.workflows.plan import read_checked_plan

KILLED = -9


@pytest.fixture
def slot():
    made = make_plan_slot()
    yield made
    os.close(made.descriptor)


@pytest.fixture
def trial(slot):
    return PlanTrial(write_memory_file(b"first"), slot)


def config(trial):
    return os.pread(trial.config_file, 100, 0)


def begun(trial, slot, text=b"other"):
    slot.write(text)
    assert trial.take(0)
    trial.begin()


def test_what_another_process_writes_is_taken_once(slot):
    writer = PlanSlot(slot.descriptor)
    assert slot.take() == b""
    writer.write(b"a longer one")
    writer.write(b"short")
    assert (slot.take(), slot.take()) == (b"short", b"")
    assert PlanSlot(slot.descriptor).take() == b"short"


def test_without_a_plan_nothing_changes(trial):
    assert not trial.take(0)
    trial.begin()
    trial.watch(PLAN_TRIAL)
    assert not trial.guard_ended(KILLED)
    assert not trial.give_up(PREPARE_TIMEOUT + 1)
    assert config(trial) == b"first"


def test_a_guard_that_takes_no_plans_has_no_slot():
    trial = PlanTrial(write_memory_file(b"first"), None)
    assert (trial.take(0), trial.slot_files) == (False, [])


def test_a_plan_that_serves_stays_even_if_its_guard_ends_later(trial, slot):
    begun(trial, slot)
    trial.watch(PLAN_TRIAL)
    assert not trial.guard_ended(KILLED)
    assert config(trial) == b"other"


def test_a_guard_that_ends_during_the_trial_gives_place_to_the_former_plan(trial, slot):
    begun(trial, slot)
    trial.watch(PLAN_TRIAL - 1)
    assert trial.guard_ended(KILLED)
    assert config(trial) == b"first"
    assert not trial.guard_ended(KILLED)


def test_a_guard_that_could_not_be_started_has_not_tried_the_plan(trial, slot):
    begun(trial, slot)
    assert not trial.guard_ended(START_FAILED)
    assert config(trial) == b"other"
    assert trial.guard_ended(KILLED)
    assert config(trial) == b"first"


def test_a_guard_that_ends_before_the_next_one_is_ready_does_not_end_the_trial(trial, slot):
    slot.write(b"other")
    trial.take(0)
    assert trial.is_prepared
    assert not trial.guard_ended(KILLED)
    trial.begin()
    assert not trial.is_prepared
    assert config(trial) == b"other"


def test_a_plan_for_which_no_guard_gets_ready_is_given_up(trial, slot):
    slot.write(b"other")
    trial.take(7)
    assert not trial.give_up(7 + PREPARE_TIMEOUT)
    assert trial.give_up(8 + PREPARE_TIMEOUT)
    assert (config(trial), trial.is_prepared) == (b"first", False)


def test_a_plan_waits_for_the_end_of_the_trial_before(trial, slot):
    begun(trial, slot)
    slot.write(b"third")
    assert not trial.take(0)
    trial.watch(PLAN_TRIAL)
    assert trial.take(0)
    assert config(trial) == b"third"


def test_one_plan_after_another_goes_back_to_the_one_before_alone(trial, slot):
    begun(trial, slot)
    trial.watch(PLAN_TRIAL)
    begun(trial, slot, b"third")
    assert trial.guard_ended(KILLED)
    assert config(trial) == b"other"


def test_only_a_guard_that_serves_makes_place():
    fsm = SupervisorFsm(0, Supervision())
    assert not fsm.replace_guard()
    fsm.tick(0, GuardObservation(0, is_serving=False))
    assert not fsm.replace_guard()
    fsm.tick(1, GuardObservation(0, is_serving=True))
    assert fsm.replace_guard()
    assert fsm.phase is GuardPhase.KILLED
    assert not fsm.replace_guard()


def test_a_guard_that_is_told_to_end_makes_no_place():
    fsm = SupervisorFsm(0, Supervision())
    fsm.tick(0, GuardObservation(0, is_serving=False))
    fsm.tick(1, GuardObservation(0, is_serving=True))
    fsm.shut_down(1)
    assert not fsm.replace_guard()


def test_a_guard_with_another_plan_is_known_to_a_supervisor_that_starts_with_it(tmp_path):
    plans = PlanFolder(folder=tmp_path, start=Plan(app="a"), read=read_checked_plan)
    link = LinkOptions(
        service="https://x", token_file=tmp_path, robot="r", state=tmp_path, plans=plans
    )
    options = {"dry_run": False, "control": None, "figures": None, "link": link}
    started = GuardConfig(plan=Plan(app="a"), master="m", options=options)
    other = Plan(app="a", revision=7)
    switched = pickled(replace(pickled(started), plan=other))
    assert switched.digest == pickled(replace(started, plan=other)).digest
    assert switched.digest != pickled(started).digest


def pickled(config):
    return pickle.loads(pickle.dumps(config))
