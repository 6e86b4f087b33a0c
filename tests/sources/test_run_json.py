"""A run as JSON: what is written is read, and what is no run is refused with its place."""

import json
from copy import deepcopy

import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from rtron.errors import InputError
from rtron.sources.run_json import MAX_NUMBER, read_run, run_to_json
from rtron.vocabulary import (
    Decision,
    DurationStatistics,
    EventStatistics,
    FlowStatistics,
    MeasuredRun,
    Mode,
    MonitorStatistics,
    OverlapStatistics,
    PolicyName,
    RefusalStatistics,
    StreamStatistics,
    ValueStatistics,
)

GAPS = DurationStatistics(count=3, p50=1, p99=2, p999=3, max=3)
RUN = MeasuredRun(
    app="base",
    duration=9,
    streams=(
        StreamStatistics(
            topic="/cmd_vel",
            mode=Mode.ENFORCE,
            flows=(
                FlowStatistics(
                    flow="flow1",
                    publisher="/nav",
                    messages=4,
                    gaps=GAPS,
                    refusals=(
                        RefusalStatistics(
                            policy=PolicyName.PREEMPTION,
                            decision=Decision.DROP,
                            count=1,
                            reason="flow2 has the output",
                        ),
                    ),
                    overlaps=(OverlapStatistics(flow="flow2", duration=7),),
                ),
            ),
            per_frame=ValueStatistics(count=1, min=0.1, p50=0.1, p99=0.1, p999=0.1, max=0.1),
            strangers=("/rviz",),
        ),
    ),
    monitors=(MonitorStatistics(id="fps_cam", frames=4, gaps=GAPS),),
    events=(EventStatistics(name="eflow1"),),
)


@pytest.fixture
def read(tmp_path):
    def read(text):
        path = tmp_path / "run.json"
        path.write_text(text if isinstance(text, str) else json.dumps(text))
        return read_run(path)

    return read


def document():
    return json.loads(json.dumps(run_to_json(RUN)))


def test_what_is_written_is_read(read):
    assert read(document()) == RUN


def at(path, value):
    """Return a run's document with another value at a path of keys."""
    made = deepcopy(document())
    place = made
    for key in path[:-1]:
        place = place[key]
    place[path[-1]] = value
    return made


FLOW = ("streams", 0, "flows", 0)
FAULTS = [
    (("schema",), "rtron.run/2", "schema"),
    (("extra",), 1, "extra: no key"),
    ((*FLOW, "extra"), 1, "streams[0].flows[0].extra: no key"),
    ((*FLOW, "gaps", "extra"), 1, "gaps.extra: no key"),
    ((*FLOW, "messages"), -1, "streams[0].flows[0].messages: not between"),
    ((*FLOW, "messages"), MAX_NUMBER + 1, "messages: not between"),
    ((*FLOW, "messages"), 10**4000, "messages: not between"),
    ((*FLOW, "messages"), "4", "messages"),
    ((*FLOW, "messages"), 4.5, "messages"),
    ((*FLOW, "messages"), True, "messages"),
    ((*FLOW, "gaps", "max"), 2, "gaps: quantiles that fall"),
    ((*FLOW, "gaps", "p50"), 3, "gaps: quantiles that fall"),
    ((*FLOW, "publisher"), "/" + 1000 * "n", "publisher: longer than"),
    ((*FLOW, "refusals", 0, "decision"), "maybe", "decision"),
    (("streams", 0, "mode"), "loud", "mode"),
    (("streams", 0, "per_frame", "max"), float("nan"), "per_frame.max"),
    (("streams", 0, "per_frame", "max"), float("inf"), "per_frame.max"),
    (("streams", 0, "per_frame", "min"), -0.1, "per_frame.min: not between"),
    (("streams", 0, "per_frame", "min"), 0.2, "per_frame: quantiles that fall"),
    (("streams",), {}, "streams"),
    (("ros",), 3, "ros"),
]


@pytest.mark.parametrize(("path", "value", "told"), FAULTS)
def test_a_fault_is_told_with_its_place(read, path, value, told):
    with pytest.raises(InputError, match=r"run\.json") as caught:
        read(at(path, value))
    assert told in str(caught.value)
    assert len(str(caught.value)) < 500
    assert "--measurements" in caught.value.help


@pytest.mark.parametrize("value", [0, MAX_NUMBER])
def test_the_bounds_are_in(read, value):
    assert read(at(("duration",), value)).duration == value


@pytest.mark.parametrize("text", ["", "{", "[]", "null", "[" * 100_000, '{"a":' * 50_000, "\x00"])
def test_what_is_no_run_is_refused(read, text):
    with pytest.raises(InputError):
        read(text)


@settings(deadline=None)
@given(st.recursive(st.none() | st.booleans() | st.floats() | st.text(), st.lists, max_leaves=9))
def test_other_json_is_an_input_error(tmp_path_factory, value):
    assume(value != [])
    path = tmp_path_factory.mktemp("run") / "run.json"
    path.write_text(json.dumps({**document(), "streams": value}))
    with pytest.raises(InputError):
        read_run(path)


def test_there_is_a_most(tmp_path):
    path = tmp_path / "run.json"
    path.write_bytes(b" " * (16 * 2**20 + 1))
    with pytest.raises(InputError, match="larger than 16 MiB"):
        read_run(path)
