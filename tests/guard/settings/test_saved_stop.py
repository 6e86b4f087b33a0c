"""The emergency stop from the file of the link process, without the bulk process."""

import os

import pytest
from harness import wait_for
from settings_app import WALL, Base

from rtron.errors import SourceError
from rtron.guard.core.event_loop import EventLoop
from rtron.guard.link.options import LinkOptions
from rtron.guard.link.settings_file import read_settings, write_settings
from rtron.guard.settings import saved_settings
from rtron.guard.settings.in_force import SettingsInForce
from rtron.guard.settings.saved_settings import SavedStop, settings_at_start
from rtron.guard.system.machine_time import machine_time
from rtron.vocabulary import EmergencyStop, Settings

STOP = EmergencyStop(by="ann", reason="a child", at=WALL)


class Watching:
    """A guard whose settings come from nowhere but the file."""

    def __init__(self, folder, loop):
        token = folder / "token"
        self.options = LinkOptions(service="http://s", token_file=token, robot="r", state=folder)
        self.loop = loop
        self.settings = SettingsInForce(Base().applying)
        self.part = SavedStop(self.settings, self.options, loop)
        self.part.open()

    def write(self, settings):
        write_settings(self.options.settings_file, settings, machine_time())

    def stops(self):
        self.loop.step(0.05)
        return self.settings.is_stopped

    def looks(self, times=4):
        """Let it look some times; tell whether it stops then."""
        until = self.loop.now() + times * 10**8
        while self.loop.now() < until:
            self.loop.step(0.05)
        return self.settings.is_stopped


@pytest.fixture
def watching(tmp_path):
    loop = EventLoop()
    yield Watching(tmp_path, loop)
    loop.close()


def test_a_stop_that_was_kept_is_in_force_soon(watching):
    assert not watching.looks()
    watching.write(Settings(revision=2, stop=STOP))
    wait_for(watching.stops, what="the stop")
    assert watching.settings.current.stop == STOP
    assert watching.settings.revision < 2, "nothing else of them is in force"


def test_settings_without_a_stop_and_older_ones_change_nothing(watching):
    watching.write(Settings(revision=5))
    assert not watching.looks()
    assert watching.settings.apply(Settings(revision=6)) == ""
    watching.write(Settings(revision=6, stop=STOP))
    assert not watching.looks()


def test_a_stop_is_not_released_by_the_file(watching):
    watching.write(Settings(revision=2, stop=STOP))
    wait_for(watching.stops, what="the stop")
    watching.write(Settings(revision=3))
    assert watching.looks()
    assert watching.settings.apply(Settings(revision=3)) == ""
    assert not watching.settings.is_stopped


@pytest.mark.parametrize("content", [b"", b"no JSON", b"{}"])
def test_a_file_that_cannot_be_read_stops_nothing_and_ends_nothing(watching, content):
    watching.options.settings_file.write_bytes(content)
    assert not watching.looks()
    watching.write(Settings(revision=2, stop=STOP))
    wait_for(watching.stops, what="the stop")


def test_a_stop_is_not_lost_because_one_look_has_failed(watching, monkeypatch, caplog):
    looks = []

    def read_late(path, at):
        looks.append(path)
        if len(looks) < 3:
            raise SourceError("too many open files")
        return read_settings(path, at)

    monkeypatch.setattr(saved_settings, "read_settings", read_late)
    watching.write(Settings(revision=2, stop=STOP))
    wait_for(watching.stops, what="the stop")
    assert caplog.text.count("too many open files") == 1


def begin(watching):
    settings_at_start(watching.settings, watching.options)
    return watching.settings


@pytest.mark.parametrize("content", [b"", b"\0" * 99, b'{"type": "settings", "set'])
def test_a_guard_that_begins_and_cannot_read_them_is_stopped_until_the_service_says(
    watching, content
):
    watching.options.settings_file.write_bytes(content)
    assert begin(watching).is_stopped
    assert "a stop may be among them" in watching.settings.current.stop.reason
    assert watching.settings.apply(Settings(revision=6)) == ""
    assert not watching.settings.is_stopped


def test_a_folder_in_the_place_of_the_settings_is_a_stop(watching):
    watching.options.settings_file.mkdir()
    assert begin(watching).is_stopped


def test_a_guard_that_begins_without_settings_is_not_stopped(watching):
    assert not begin(watching).is_stopped


def test_a_disk_that_hangs_keeps_the_loop_from_nothing(watching):
    """Who opens a named pipe waits for its writer."""
    pipe = watching.options.state / "pipe"
    os.mkfifo(pipe)
    os.link(pipe, watching.options.settings_file)
    assert not watching.looks()
    watching.write(Settings(revision=2, stop=STOP))
    assert not watching.looks()
    pipe.write_bytes(b"")
    wait_for(watching.stops, what="the stop")


def test_an_error_of_ours_refuses_settings_and_their_stop_is_in_force(watching, monkeypatch):
    applier = watching.settings._applier
    apply, failures = applier.apply, [ValueError("ours")]

    def fail_once(settings, now):
        if failures:
            raise failures.pop()
        apply(settings, now)

    monkeypatch.setattr(applier, "apply", fail_once)
    assert "internal error: ours" in watching.settings.apply(Settings(revision=2, stop=STOP))
    assert watching.settings.is_stopped
    assert "revision 2 is refused" in watching.settings.refusal
