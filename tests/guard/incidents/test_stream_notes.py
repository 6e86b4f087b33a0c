"""What the streams of a process note of messages and verdicts, without any I/O."""

from dataclasses import replace

from guarded_drive import ALLOWED, FAST, TOPIC, Drive, posed_plan, speed_plan
from leased_base import LeasedBase
from velocity_messages import speeds, twist

from rtron.guard.incidents.entries import (
    LONGEST_MESSAGE,
    ControlState,
    EntriesLost,
    EntryBuffer,
    EventMessage,
    LearnedType,
    LeaseAnswered,
    Received,
    RuleSwitched,
    Sent,
)
from rtron.guard.incidents.stream_notes import StreamNotes
from rtron.vocabulary import SECOND, Decision, Mode, PolicyName


def noted_drive(max_bytes=1 << 20):
    drive = Drive(speed_plan(), SECOND)
    notes = StreamNotes(drive.host, drive.transport.now, max_bytes)
    notes.open()
    return drive, notes


def of_kind(entries, kind):
    return [entry for entry in entries if isinstance(entry, kind)]


def test_a_message_is_noted_as_it_came_and_as_it_went_with_its_verdict():
    drive, notes = noted_drive()
    drive.command(FAST)
    entries = notes.take(1 << 20)
    (received,), (sent,) = of_kind(entries, Received), of_kind(entries, Sent)
    assert speeds([received.message]) == [(FAST, 0.0)]
    assert speeds([sent.message]) == [(ALLOWED, 0.0)] == speeds(drive.driven)
    assert (received.decision, received.policy) == (Decision.MODIFY, PolicyName.CONSTRAIN)
    assert (received.at, received.topic, received.flow) == (SECOND, TOPIC, "flow1")
    assert sent.stopping == ""


def test_who_is_in_command_is_noted_when_it_changes():
    drive, notes = noted_drive()
    drive.command(0.1)
    (state,) = of_kind(notes.take(1 << 20), ControlState)
    assert (state.owner, state.publisher, state.limit) == ("flow1", "/teleop", ALLOWED)
    drive.transport.advance(SECOND // 10)
    assert of_kind(notes.take(1 << 20), ControlState) == []


def test_who_is_in_command_is_noted_again_each_second_since_an_incident_begins_anywhere():
    drive, notes = noted_drive()
    drive.command(0.1)
    noted = []
    for _ in range(4 * 20):
        noted += of_kind(notes.take(1 << 20), ControlState)
        drive.command(0.1)
        drive.transport.advance(SECOND // 20)
    assert [state.owner for state in noted] == ["flow1"] * 4


def test_a_stop_is_noted_with_its_reason():
    drive, notes = noted_drive()
    drive.command(0.2)
    drive.transport.advance(2 * SECOND)
    stops = [sent for sent in of_kind(notes.take(1 << 20), Sent) if sent.stopping]
    assert stops
    assert speeds([stops[-1].message]) == [(0.0, 0.0)]


def test_requests_of_leases_are_noted_with_their_answers():
    base = LeasedBase()
    notes = StreamNotes(base.host, base.transport.now, 1 << 20)
    notes.open()
    base.ask("/teleop", "acquire a drive")
    base.ask("/nav", "acquire mine")
    first, second = of_kind(notes.take(1 << 20), LeaseAnswered)
    assert (first.lease, first.request, first.granted) == ("base", "acquire by /teleop", True)
    assert (second.request, second.granted) == ("acquire by /nav", False)
    assert "/teleop" in second.reason


def test_a_type_is_noted_once_and_again_for_who_has_just_begun():
    drive, notes = noted_drive()
    drive.command(0.1)
    (learned,) = of_kind(notes.take(1 << 20), LearnedType)
    assert learned.publishers == (("flow1", "/teleop"),)
    assert of_kind(notes.take(1 << 20), LearnedType) == []
    notes.forget()
    assert of_kind(notes.take(1 << 20), LearnedType) == [learned]


def test_of_a_long_message_only_the_verdict_is_kept():
    drive, notes = noted_drive()
    drive.command(0.1)
    drive.host.streams[0].receive("flow1", twist() + bytes(LONGEST_MESSAGE))
    received = of_kind(notes.take(1 << 20), Received)[-1]
    assert (received.message, received.size) == (b"", len(twist()) + LONGEST_MESSAGE)


def test_a_message_that_events_are_read_from_is_noted_with_its_publisher():
    drive = Drive(posed_plan(), SECOND)
    notes = StreamNotes(drive.host, drive.transport.now, 1 << 20)
    notes.open()
    drive.be_at(1.0)
    (event,) = of_kind(notes.take(1 << 20), EventMessage)
    assert (event.topic, event.publisher) == ("/pose", "/amcl")
    assert event.type == "geometry_msgs/PoseStamped"


def test_a_stream_that_is_only_observed_is_not_noted():
    plan = speed_plan()
    grcn = tuple(replace(each, mode=Mode.OBSERVE) for each in plan.grcn)
    rsrcn = replace(plan.rsrcn, mode=Mode.OBSERVE)
    drive = Drive(replace(plan, grcn=grcn, rsrcn=rsrcn), SECOND)
    notes = StreamNotes(drive.host, drive.transport.now, 1 << 20)
    notes.open()
    drive.host.streams[0].receive("flow1", twist(x=FAST))
    assert notes.take(1 << 20) == []


def test_what_finds_no_room_is_counted():
    drive, notes = noted_drive(max_bytes=4000)
    for _ in range(100):
        drive.command(0.1)
    entries = notes.take(1 << 20)
    (lost,) = of_kind(entries, EntriesLost)
    assert lost.number + len(of_kind(entries, Received)) + len(of_kind(entries, Sent)) >= 200
    drive.command(0.1)
    assert of_kind(notes.take(1 << 20), EntriesLost) == []


def test_a_batch_is_bounded_and_the_rest_follows_in_order():
    buffer = EntryBuffer(1 << 20)
    for number in range(100):
        buffer.add(RuleSwitched(number, "rule", True, ""))  # noqa: FBT003
    batches = [buffer.take(2560, 0) for _ in range(11)]
    assert [len(batch) for batch in batches] == [10] * 10 + [0]
    assert [entry.at for batch in batches for entry in batch] == list(range(100))
