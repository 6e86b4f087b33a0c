"""What intruders have stopped is there for the next guard, although no process has outlived."""

import json
from dataclasses import replace

import pytest
from harness import wait_for
from plans import grcn, plan_of

from rtron.errors import SourceError
from rtron.guard.core.handover_state import HandoverState
from rtron.guard.intrusion_latch import IntrusionLatch, intrusion_file

PLAN = plan_of(grcn("/cmd_vel", ("/nav",), ("/driver",)))
TOPIC = PLAN.grcn[0].topic
STOPPED = {TOPIC: "a ghost"}


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path))
    return tmp_path / "rtron" / PLAN.app


class Guard:
    """The first guard of a supervisor, or one that a guard before has left a document."""

    def __init__(self, document=b"", plan=PLAN, master="http://localhost:11311"):
        self.documents = [document]
        self.latch = IntrusionLatch(HandoverState(document, self.documents.append))
        self.file = intrusion_file(plan, master)
        self.latch.keep(self.file, {TOPIC})
        self.wait()

    def wait(self):
        wait_for(lambda: self.file.is_saved, what="the file")

    def stop(self, topic=TOPIC, why=STOPPED[TOPIC]):
        self.latch.add(topic, why)
        self.wait()


def test_the_next_guard_stops_what_was_not_cleared(folder):
    first = Guard()
    assert first.latch.reasons == {}
    first.stop()
    second = Guard()
    assert second.latch.reasons == STOPPED
    second.latch.remove(TOPIC)
    second.wait()
    assert Guard().latch.reasons == {}
    assert list(folder.iterdir()) == []


def test_what_the_guard_before_has_left_counts_more_than_the_file(folder):
    first = Guard()
    first.stop()
    first.latch.remove(TOPIC)
    cleared, path = first.documents[-1], folder / "intrusions-http___localhost_11311.json"
    path.write_text(json.dumps(STOPPED))  # it was killed before the disk had it
    assert Guard(cleared).latch.reasons == {}
    assert not path.exists()


def test_what_the_guard_before_could_not_save_is_saved(folder):
    first = Guard()
    first.stop()
    (path,) = folder.iterdir()
    path.unlink()
    assert Guard(first.documents[-1]).latch.reasons == STOPPED
    assert json.loads(path.read_text()) == STOPPED


@pytest.mark.parametrize(
    "other", [{"master": "http://robot:11311"}, {"plan": replace(PLAN, app="another")}]
)
def test_another_master_and_another_app_have_intrusions_of_their_own(folder, other):
    Guard().stop()
    assert Guard(**other).latch.reasons == {}
    assert Guard().latch.reasons == STOPPED


def test_what_the_plan_has_no_more_is_void(folder):
    guard = Guard()
    guard.stop()
    guard.stop("/gone", "a ghost")
    assert Guard().latch.reasons == STOPPED


@pytest.mark.parametrize("content", ["", "{", "[]", "1", "[" * 100_000, '{"/cmd_vel": "a'])
def test_a_file_that_cannot_be_read_is_refused(folder, content):
    Guard().stop()
    (path,) = folder.iterdir()
    path.write_text(content)
    with pytest.raises(SourceError, match="cannot be read") as error:
        Guard()
    assert str(path) in str(error.value)
    assert "remove the file" in error.value.help


def test_a_reason_that_is_no_text_stops_all_the_same(folder):
    Guard().stop()
    (path,) = folder.iterdir()
    path.write_text('{"/cmd_vel": 1}')
    assert Guard().latch.reasons == {TOPIC: "1"}


def test_a_folder_that_others_may_enter_is_refused(folder):
    folder.mkdir(parents=True)
    folder.chmod(0o755)
    with pytest.raises(SourceError, match="others may enter"):
        Guard()


def test_what_could_not_be_written_is_tried_again(folder, caplog):
    guard = Guard()
    folder.chmod(0o755)
    guard.latch.add(TOPIC, "a ghost")
    wait_for(lambda: "is not kept" in caplog.text, what="the failure")
    assert list(folder.iterdir()) == []
    folder.chmod(0o700)
    guard.wait()
    assert Guard().latch.reasons == STOPPED


def test_a_strange_reason_comes_back_as_it_was(folder):
    reason = 'a "\N{GHOST}"\n\x00'
    Guard().stop(why=reason)
    assert Guard().latch.reasons == {TOPIC: reason}


def test_an_end_waits_for_the_disk_and_says_what_is_not_on_it(folder, caplog):
    guard = Guard()
    guard.latch.add(TOPIC, "a ghost")
    guard.file.close()
    assert Guard().latch.reasons == STOPPED
    folder.chmod(0o755)
    guard.latch.remove(TOPIC)
    caplog.clear()
    guard.file.close()
    assert guard.file.failure
    assert caplog.messages[-1].endswith(guard.file.failure)
    folder.chmod(0o700)
