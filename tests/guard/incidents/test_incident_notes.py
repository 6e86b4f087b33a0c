"""What the command process notes on its way to the bulk process: bounded, and never in the way."""

import pickle

import pytest
from guarded_drive import Drive, speed_plan

from rtron.guard.core.event_loop import EventLoop
from rtron.guard.incidents.entries import EntriesLost, LearnedType, Received, Sent
from rtron.guard.incidents.stream_notes import BATCH_BYTES, MAX_WAITING_BYTES, IncidentNotes
from rtron.guard.lanes.exchange.message_channel import MAX_MESSAGE_BYTES

FLOOD = 4000


class Line:
    """A connection to a bulk process that reads when a test says so."""

    def __init__(self):
        self.connect_listeners = []
        self.is_ready = False
        self.sent = []

    def call(self, name, entries):
        assert name == "note_entries"
        self.sent.append(entries)

    def entries(self, kind):
        return [each for batch in self.sent for each in batch if isinstance(each, kind)]


@pytest.fixture
def noting():
    loop = EventLoop()
    drive = Drive(speed_plan(), loop.now())
    drive.line, drive.loop = Line(), loop
    drive.notes = IncidentNotes(drive.line, drive.host, loop)
    drive.notes.open()
    yield drive
    loop.close()


def serve(drive, condition):
    for _ in range(1000):
        if condition():
            return
        drive.loop.step(0.02)
    raise AssertionError


def test_nothing_goes_while_the_other_process_reads_nothing(noting):
    noting.command(0.1)
    for _ in range(5):
        noting.loop.step(0.02)
    assert noting.line.sent == []
    noting.line.is_ready = True
    serve(noting, lambda: noting.line.entries(Received))
    assert len(noting.line.entries(Received)) == 1


def test_a_flood_goes_in_batches_that_are_short_and_the_rest_is_counted(noting):
    for _ in range(FLOOD):
        noting.command(0.1)
    noting.line.is_ready = True

    def accounted():
        lost = sum(each.number for each in noting.line.entries(EntriesLost))
        return lost + len(noting.line.entries(Received)) + len(noting.line.entries(Sent))

    serve(noting, lambda: accounted() >= 2 * FLOOD)
    assert accounted() - 2 * FLOOD <= 1, "a state may be among what is lost"
    assert len(noting.line.entries(Received)) < MAX_WAITING_BYTES // 500
    sizes = [len(pickle.dumps(batch)) for batch in noting.line.sent]
    assert max(sizes) < 2 * BATCH_BYTES < MAX_MESSAGE_BYTES


def test_the_next_bulk_process_learns_the_types_again(noting):
    noting.line.is_ready = True
    noting.command(0.1)
    serve(noting, lambda: noting.line.entries(LearnedType))
    noting.line.sent.clear()
    for listener in noting.line.connect_listeners:
        listener()
    serve(noting, lambda: noting.line.entries(LearnedType))


def test_what_is_left_goes_when_the_process_ends(noting):
    noting.line.is_ready = True
    noting.command(0.1)
    noting.notes.close()
    assert noting.line.sent
    assert noting.line.entries(Received)
