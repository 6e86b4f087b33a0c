"""What intruders have stopped is there for the next guard, although no process has outlived."""

import json
from dataclasses import replace

import pytest
from harness import wait_for
from plans import grcn, plan_of

from rtron.errors import SourceError
from rtron.guard.intrusion_latch import handover_document, intrusions_in
from rtron.guard.supervision.guard_config import GuardConfig
from rtron.guard.supervision.intrusion_file import intrusion_file
from rtron.guard.supervision.shared_memory import GuardMemory
from rtron.vocabulary import Audit, OnForeign

PLAN = plan_of(grcn("/cmd_vel", ("/nav",), ("/driver",)))
TOPIC = PLAN.grcn[0].topic
STOPPED = {TOPIC: "a ghost"}


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path))
    return tmp_path / "rtron" / PLAN.app


@pytest.fixture
def state():
    memory = GuardMemory.create(1)
    yield memory.handover_state
    memory.close()


def file_of(plan=PLAN, master="http://localhost:11311", **options):
    return intrusion_file(GuardConfig(plan=plan, master=master, options=options))


def inherited(**more):
    return intrusions_in(file_of(**more).handover_document())


def keep(state, reasons, file=None):
    """Let a guard tell of intrusions, and wait until they are saved."""
    file = file or file_of()
    state.write(handover_document(reasons))
    file.follow(state)
    wait_for(lambda: file.is_saved, what="the file")


def test_the_next_guard_inherits_what_was_not_cleared(folder, state):
    assert inherited() == {}
    keep(state, STOPPED)
    assert inherited() == STOPPED
    keep(state, {})
    assert inherited() == {}
    assert list(folder.iterdir()) == []


def test_a_file_that_has_inherited_follows_what_is_cleared(folder, state):
    keep(state, STOPPED)
    file = file_of()
    assert intrusions_in(file.handover_document()) == STOPPED
    keep(state, {}, file)
    assert inherited() == {}


def test_a_guard_that_was_cleared_without_a_supervisor_leaves_nothing(folder, state):
    keep(state, STOPPED)
    keep(state, {}, file_of())
    assert inherited() == {}


@pytest.mark.parametrize(
    "other", [{"master": "http://robot:11311"}, {"plan": replace(PLAN, app="another")}]
)
def test_another_master_and_another_app_have_intrusions_of_their_own(folder, state, other):
    keep(state, STOPPED)
    assert inherited(**other) == {}
    assert inherited() == STOPPED


def test_what_the_plan_has_no_more_is_void(folder, state):
    keep(state, {**STOPPED, "/gone": "a ghost"})
    assert inherited() == STOPPED


def test_two_writers_that_write_one_count_are_both_followed(folder, state):
    file = file_of()
    keep(state, {}, file)
    late = GuardMemory.create(1)
    late.handover_state.write(b"{}")
    file.follow(late.handover_state)
    late.handover_state._write_count = 0
    keep(late.handover_state, STOPPED, file)
    assert inherited() == STOPPED
    late.close()


def test_where_intruders_stop_nothing_there_is_no_file():
    alarm = replace(PLAN, audit=Audit(on_foreign=OnForeign.ALARM))
    assert file_of(dry_run=True) is None
    assert file_of(plan=alarm) is None


@pytest.mark.parametrize("content", ["", "{", "[]", "1", "[" * 100_000, '{"/cmd_vel": "a'])
def test_a_file_that_cannot_be_read_is_refused(folder, state, content):
    keep(state, STOPPED)
    (path,) = folder.iterdir()
    path.write_text(content)
    with pytest.raises(SourceError, match="cannot be read") as error:
        file_of().handover_document()
    assert str(path) in str(error.value)
    assert "remove the file" in error.value.help


def test_a_folder_that_others_may_enter_is_refused(folder):
    folder.mkdir(parents=True)
    folder.chmod(0o755)
    with pytest.raises(SourceError, match="others may enter"):
        file_of().handover_document()


def test_what_could_not_be_written_is_tried_again(folder, state, caplog):
    folder.mkdir(parents=True)
    folder.chmod(0o755)
    file = file_of()
    state.write(handover_document(STOPPED))
    file.follow(state)
    wait_for(lambda: "is not kept" in caplog.text, what="the failure")
    assert list(folder.iterdir()) == []
    folder.chmod(0o700)
    wait_for(lambda: file.is_saved, what="the file")
    assert inherited() == STOPPED


def test_a_guard_that_has_told_nothing_yet_leaves_the_file_as_it_is(folder, state):
    keep(state, STOPPED)
    file = file_of()
    empty = GuardMemory.create(1)
    file.follow(empty.handover_state)
    empty.close()
    wait_for(lambda: file.is_saved, what="the file")
    assert inherited() == STOPPED


def test_a_strange_reason_comes_back_as_it_was(folder, state):
    reasons = {TOPIC: 'a "\N{GHOST}"\n\x00'}
    keep(state, reasons)
    (path,) = folder.iterdir()
    assert json.loads(path.read_text()) == reasons
    assert inherited() == reasons


def test_an_end_waits_for_the_disk_and_says_what_is_not_on_it(folder, state, caplog):
    file = file_of()
    state.write(handover_document(STOPPED))
    file.follow(state)
    file.finish(20.0)
    assert inherited() == STOPPED
    folder.chmod(0o755)
    state.write(handover_document({}))
    file.follow(state)
    file.finish(0.0)
    assert "what intruders have stopped is not saved" in caplog.text
    folder.chmod(0o700)
