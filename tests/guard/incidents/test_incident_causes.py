"""When an incident is saved."""

from itertools import pairwise

from hypothesis import given
from hypothesis import strategies as st

from rtron.guard.incidents.causes import IN_FLIGHT, MAX_CAUSES, CauseDetector
from rtron.guard.incidents.entries import AlarmSwitched, ControlState, Received, Sent
from rtron.vocabulary import SECOND, IncidentRecording

RECORDING = IncidentRecording(keep=60 * SECOND, after=5 * SECOND)


def received(at, decision="drop", flow="teleop", policy="Block", reason="rule stop"):
    return Received(at, "/cmd_vel", flow, b"x", 1, "", decision, policy, reason, 3)


def sent(at, stopping=""):
    return Sent(at, "/cmd_vel", "teleop", b"x", 1, stopping)


def alarm(at, kind="intrusion", *, active=True):
    return AlarmSwitched(at, kind, "/cmd_vel", "/ghost publishes", active)


def incidents(entries, until):
    """Return what is due, looked at every tenth of a second of the entries' times."""
    detector, found, now = CauseDetector(RECORDING), [], 0
    entries = sorted(entries, key=lambda entry: entry.at)
    while now <= until:
        while entries and entries[0].at <= now:
            detector.note(entries.pop(0))
        if due := detector.take_due(now):
            found.append(due)
        now += SECOND // 10
    return found


def test_what_passes_is_no_cause():
    quiet = [received(at * SECOND, "pass") for at in range(10)]
    assert incidents([*quiet, sent(SECOND), received(2 * SECOND, "hold")], 30 * SECOND) == []


def test_an_incident_has_what_was_before_and_some_seconds_behind():
    (due,) = incidents([received(100 * SECOND)], 120 * SECOND)
    assert (due.begin, due.end) == (40 * SECOND, 105 * SECOND)
    (cause,) = due.causes
    assert (cause.kind, cause.topic, cause.flow) == ("intervention", "/cmd_vel", "teleop")
    assert cause.reason == "drop: rule stop"


def test_nothing_is_due_before_its_seconds_are_over():
    detector = CauseDetector(RECORDING)
    detector.note(alarm(SECOND))
    due_at = 6 * SECOND + IN_FLIGHT
    assert detector.take_due(due_at - 1) is None
    assert detector.take_due(due_at).end == 6 * SECOND
    assert detector.take_due(7 * SECOND) is None


def test_an_intruder_at_200_hz_makes_one_incident():
    flood = [received(at * SECOND // 200, flow="unapproved") for at in range(1, 200 * 90)]
    assert len(incidents(flood, 100 * SECOND)) == 1


def test_what_comes_back_after_the_time_that_is_kept_is_another_incident():
    again = 60 * SECOND + 1
    assert len(incidents([received(0), received(60 * SECOND)], 90 * SECOND)) == 1
    assert len(incidents([received(0), received(again)], 90 * SECOND)) == 2


def test_what_goes_on_hides_nothing_that_happens_for_another_reason():
    usual = [sent(at * SECOND, f"silent for 0.{at} s") for at in range(0, 300, 20)]
    usual += [received(at * SECOND, reason=f"0.{at} m/s is too fast") for at in range(0, 300, 20)]
    grave = [sent(150 * SECOND, "a person on the track"), received(151 * SECOND, reason="kitchen")]
    first, second = incidents([*usual, *grave], 400 * SECOND)
    assert [each.reason for each in first.causes] == [
        "silent for 0.0 s",
        "drop: 0.0 m/s is too fast",
    ]
    assert [each.reason for each in second.causes] == ["a person on the track", "drop: kitchen"]


def test_causes_together_are_one_incident_named_by_the_first():
    together = [alarm(SECOND), received(2 * SECOND), sent(3 * SECOND, "silent for 0.5 s")]
    (due,) = incidents(together, 30 * SECOND)
    assert [cause.kind for cause in due.causes] == ["alarm", "intervention", "stop"]
    assert due.causes[0].reason == "intrusion: /ghost publishes"


def test_a_second_incident_waits_and_loses_nothing():
    first, second = incidents([alarm(0), sent(10 * SECOND, "silent")], 60 * SECOND)
    assert first.end == 5 * SECOND
    assert 35 * SECOND <= second.end <= 36 * SECOND
    assert second.begin <= 10 * SECOND - 60 * SECOND + SECOND


def test_a_cause_behind_the_end_of_an_incident_is_in_the_next_one():
    first, second = incidents([alarm(0), received(5 * SECOND + 1)], 60 * SECOND)
    assert [cause.kind for cause in first.causes] == ["alarm"]
    assert [cause.kind for cause in second.causes] == ["intervention"]
    assert second.begin < 5 * SECOND + 1 < second.end


def test_many_causes_of_one_incident_take_no_place_from_the_next_one():
    many = [received(SECOND, flow=f"flow{each}") for each in range(MAX_CAUSES)]
    first, second = incidents([*many, sent(6 * SECOND + 1, "silent")], 60 * SECOND)
    assert (len(first.causes), first.omitted) == (MAX_CAUSES, 0)
    assert [cause.kind for cause in second.causes] == ["stop"]


def test_all_that_has_begun_is_given_when_the_recorder_ends():
    detector = CauseDetector(RECORDING)
    for cause in (alarm(0), received(5 * SECOND + 1)):
        detector.note(cause)
    now = 5 * SECOND + 2
    assert detector.take_due(now, at_once=True).end == 5 * SECOND
    assert detector.take_due(now, at_once=True).end == now
    assert detector.take_due(now, at_once=True) is None


def test_a_cleared_alarm_and_an_idle_stream_are_no_causes():
    idle = ControlState(SECOND, "/cmd_vel", "", "", "", None, None)
    assert incidents([alarm(0, active=False), idle], 30 * SECOND) == []


def test_a_stop_without_any_message_is_a_cause():
    state = ControlState(SECOND, "/cmd_vel", "", "", "emergency stop", None, None)
    assert [due.causes[0].reason for due in incidents([state], 30 * SECOND)] == ["emergency stop"]


def test_what_has_begun_is_given_at_once_when_the_recorder_ends():
    detector = CauseDetector(RECORDING)
    detector.note(alarm(SECOND))
    assert detector.take_due(2 * SECOND, at_once=True).end == 2 * SECOND


def test_causes_without_end_are_counted():
    many = [received(SECOND, flow=f"flow{each}") for each in range(1000)]
    (due,) = incidents(many, 30 * SECOND)
    assert len(due.causes) == MAX_CAUSES
    assert due.omitted == 1000 - MAX_CAUSES


times = st.integers(0, 3_000).map(lambda tenths: tenths * SECOND // 10)
entries = st.builds(
    received, times, st.sampled_from(["pass", "drop", "modify"]), st.sampled_from(["teleop", "nav"])
)


@given(st.lists(entries, max_size=40))
def test_incidents_never_follow_each_other_faster_than_their_gap(found):
    ends = [due.end for due in incidents(found, 400 * SECOND)]
    gap = CauseDetector(RECORDING).gap
    assert all(after - before >= gap for before, after in pairwise(ends))


@given(st.lists(entries, max_size=40))
def test_every_first_intervention_is_in_an_incident(found):
    changing = sorted(entry.at for entry in found if entry.decision != "pass")
    dues = incidents(found, 400 * SECOND)
    assert bool(changing) == bool(dues)
    if changing:
        assert dues[0].causes[0].at == changing[0]
    for due in dues:
        assert all(due.begin < cause.at <= due.end for cause in due.causes)
