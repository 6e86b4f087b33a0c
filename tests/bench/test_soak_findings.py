"""What a soak judges of an app whose guard fails for good."""

import pytest
from harness import wait_for

from bench.common import testbed
from bench.soak.app import SoakedApp
from bench.soak.base_log import Span
from bench.soak.faults import INTRUSION, Fault, RandomFaults
from bench.soak.memory import MemoryWatch
from bench.soak.plan import LOWEST
from bench.soak.processor_wait import ProcessorWait
from bench.soak.report import Findings
from rtron.vocabulary import SECOND

BEGUN = "the guard begins, process 0\n"
STOP = "the guard stands still: the robot is stopped\n"
PERIOD, LIMIT_S = SECOND // 20, 10


@pytest.fixture
def app(tmp_path):
    app = SoakedApp(testbed.Testbed({}, tmp_path), ros=1)
    (tmp_path / "errors.log").write_text(BEGUN)
    app.log.wait(BEGUN.strip(), 0, LIMIT_S)
    yield app
    app.close()


@pytest.fixture
def faults(app):
    return RandomFaults(app, seed=1)


def drive(app, seconds, until=None):
    """Let the navigation speak for some seconds, and the base move until it is stopped."""
    inputs = [f"in {at} {LOWEST} 0 0" for at in range(0, seconds * SECOND, PERIOD)]
    moved = (until or seconds) * SECOND
    outputs = [f"out {at} {LOWEST} 0 0" for at in range(0, moved, PERIOD)]
    app.files["base"].write_text("\n".join([*inputs, *outputs, f"out {moved} 0 0 0", ""]))


def over(app, faults):
    wait = ProcessorWait(app)
    wait.close()
    rows = Findings(app, faults, MemoryWatch(app), wait).rows()
    return {row.key for row in rows if row.is_over}


def test_a_guard_that_is_gone_for_good_after_a_stop_is_over_bounds(app, faults):
    drive(app, seconds=20, until=10)
    assert {"longest_rest", "ended"} <= over(app, faults)


def test_a_base_that_is_commanded_to_the_end_is_not_over_its_bounds(app, faults):
    drive(app, seconds=20)
    assert not over(app, faults) - {"ended", "goals"}


@pytest.mark.parametrize(("stops", "are_over"), [(8, False), (9, True)])
def test_stops_that_nothing_explains_have_a_rate(app, faults, tmp_path, stops, are_over):
    drive(app, seconds=60)
    with (tmp_path / "errors.log").open("a") as log:
        log.write(STOP * stops)
    wait_for(lambda: len(app.log.times(STOP.strip())) >= stops, what="the log's lines")
    assert ("false_stops" in over(app, faults)) == are_over


def test_an_intruders_stop_that_nobody_can_clear_is_over_its_bound(app, faults):
    drive(app, seconds=2)
    faults.intruders.append(Span(0, SECOND))
    faults.history.append(Fault(INTRUSION, Span(0, 61 * SECOND)))
    assert "clear" in over(app, faults)
