"""What the bulk process does to its streams for the command process, and for the next one."""

import pytest

from rtron.guard.lanes.bulk.bulk_process import HeldStreams

MAP, SCAN = "/map", "/scan"


class Brake:
    why = ""

    def hold(self, why):
        self.why = why

    def release(self):
        self.why = ""


@pytest.fixture
def brakes():
    return {MAP: Brake(), SCAN: Brake()}


@pytest.fixture
def streams(brakes):
    streams = HeldStreams(brakes)
    for topic in brakes:
        streams.hold(topic, "a rogue")
    return streams


def held(brakes):
    return {topic for topic, brake in brakes.items() if brake.why}


def test_a_stream_is_held_until_it_is_released(brakes, streams):
    assert held(brakes) == {MAP, SCAN}
    streams.release(MAP)
    assert held(brakes) == {SCAN}


@pytest.mark.parametrize("stopped", [(), (MAP,), (SCAN,), (MAP, SCAN), ("/other",)])
def test_what_the_next_command_process_has_not_stopped_is_released(brakes, streams, stopped):
    streams.release_others(frozenset(stopped))
    assert held(brakes) == {MAP, SCAN} & set(stopped)


def test_a_stream_of_another_process_is_nobodys_here(brakes, streams):
    streams.hold("/cmd_vel", "a rogue")
    streams.release("/cmd_vel")
    assert held(brakes) == {MAP, SCAN}
