"""The fps_monitors: no faster than the camera, silent at the bound, and the least of them."""

import pytest
from event_and_rate_models import NaiveFrameMonitor
from hypothesis import given
from hypothesis import strategies as st
from policy_runs import often

from rtron.policies import FrameMonitors
from rtron.policies.velocity_limit.frame_monitors import FrameRateReport
from rtron.vocabulary import SECOND, FpsMonitor, WatchedFlow

CAMERA = WatchedFlow(name="camera", topic="/raw", publisher="/camera")
WINDOW, SILENT = 5_000_000, 7_000_000
FRAME, RAW = "frame", "raw"


def monitor(id="fps_a", **others):
    bounds = {"window": WINDOW, "silent_after": SILENT}
    return FpsMonitor(id=id, node="/n", topic="/t", **{**bounds, **others})


def watch(*plans):
    return FrameMonitors(plans or [monitor()])


BOUNDS = [0, 1, 1_000_000, *(bound + d for bound in (WINDOW, SILENT) for d in (-1, 0, 1))]
gaps = st.sampled_from(BOUNDS)
heard = st.lists(
    st.tuples(gaps, st.sampled_from([FRAME, FRAME, RAW]), st.integers(0, 4)), max_size=30
)


@often
@given(heard, st.sampled_from([None, CAMERA]), st.sampled_from([WINDOW - 1, WINDOW, SILENT]))
def test_a_monitor_is_what_a_naive_model_says(heard, camera, silent_after):
    plan = monitor(camera=camera, silent_after=silent_after)
    rates, model, now = watch(plan), NaiveFrameMonitor(plan), 0
    measured = rates.monitors["fps_a"]
    for gap, what, stamp in heard:
        now += gap
        if what == FRAME:
            measured.add_frame(stamp, now)
            model.frames.frame(stamp, now)
        else:
            measured.add_camera_frame(stamp, now)
            model.camera.frame(stamp, now)
        rate = measured.rate(now)
        assert (rate.fps, rate.is_silent) == model.rate(now)
        assert rates.lowest_rate(now) == rate


def test_who_never_spoke_is_silent():
    (measured,) = watch().monitors.values()
    assert measured.rate(0) == FrameRateReport("fps_a", 0.0, None)
    assert measured.rate(0).is_silent
    assert measured.silence_deadline() is None


@pytest.mark.parametrize(("later", "silent"), [(SILENT - 1, False), (SILENT, True)])
def test_silence_counts_from_its_bound(later, silent):
    rates = watch(monitor(window=SILENT * 2))
    rates.monitors["fps_a"].add_frame(1, 3)
    assert rates.deadline(3) == 3 + SILENT
    rate = rates.lowest_rate(3 + later)
    assert rate.is_silent is silent
    assert rate.age == (None if silent else later)
    assert (rate.fps == 0) is silent


def test_between_window_and_silence_the_rate_is_0_and_known():
    rates = watch()
    rates.monitors["fps_a"].add_frame(1, 0)
    assert rates.lowest_rate(WINDOW) == FrameRateReport("fps_a", 0.0, WINDOW)


def test_a_picture_that_does_not_change_is_no_sign_of_life():
    rates = watch(monitor(window=2 * SILENT))
    for now in range(0, SILENT + 1, SILENT // 7):
        rates.monitors["fps_a"].add_frame(1, now)
    assert rates.lowest_rate(SILENT).is_silent


def test_an_image_node_is_no_faster_than_its_camera():
    rates = watch(monitor(camera=CAMERA))
    measured = rates.monitors["fps_a"]
    for stamp in (1, 2, 3):
        measured.add_frame(stamp, stamp)
    assert measured.rate(3).fps == 0
    measured.add_camera_frame(1, 3)
    assert measured.rate(3) == FrameRateReport("fps_a", SECOND / WINDOW, 0)
    for stamp in (2, 3, 4, 5):
        measured.add_camera_frame(stamp, 3)
    assert measured.rate(3).fps == 3 * SECOND / WINDOW


def test_a_camera_that_the_plan_does_not_name_is_not_heard():
    rates = watch()
    rates.monitors["fps_a"].add_frame(1, 0)
    rates.monitors["fps_a"].add_camera_frame(1, 0)
    assert rates.lowest_rate(0).fps == SECOND / WINDOW


def test_the_least_counts_and_a_silent_one_before_all():
    rates = watch(monitor("fps_a"), monitor("fps_b"), monitor("fps_c"))
    one, other, third = rates.monitors.values()
    for stamp in (1, 2, 3):
        one.add_frame(stamp, WINDOW)
    other.add_frame(1, 0)
    third.add_frame(1, WINDOW)
    assert rates.lowest_rate(WINDOW) == FrameRateReport("fps_b", 0.0, WINDOW)
    assert rates.lowest_rate(SILENT) == FrameRateReport("fps_b", 0.0, None)
    other.add_frame(2, SILENT)
    other.add_frame(3, SILENT)
    third.add_frame(2, WINDOW + 1)
    assert rates.lowest_rate(SILENT).monitor_id == "fps_b"
    one.add_frame(4, SILENT + WINDOW)
    third.add_frame(3, SILENT + WINDOW + 1)
    assert rates.lowest_rate(SILENT + WINDOW + 2).monitor_id == "fps_b"


def test_a_silent_one_is_less_than_one_without_frames():
    rates = watch(monitor("fps_a"), monitor("fps_b"))
    rates.monitors["fps_a"].add_frame(1, 0)
    assert rates.lowest_rate(WINDOW) == FrameRateReport("fps_b", 0.0, None)


def test_of_equal_rates_the_first_is_named():
    rates = watch(monitor("fps_b"), monitor("fps_a"))
    assert rates.lowest_rate(0).monitor_id == "fps_b"


def test_without_monitors_there_is_no_rate():
    assert FrameMonitors().lowest_rate(0) is None
    assert FrameMonitors().deadline(0) is None


@pytest.mark.parametrize(
    ("now", "due"), [(SILENT - 1, SILENT), (SILENT, SILENT + 1), (99**9, None)]
)
def test_the_deadline_is_the_next_silence_to_come(now, due):
    rates = watch(monitor("fps_a"), monitor("fps_b"), monitor("fps_c"))
    rates.monitors["fps_a"].add_frame(1, 0)
    rates.monitors["fps_b"].add_frame(1, 1)
    assert rates.deadline(now) == due
