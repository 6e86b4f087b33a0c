"""A guarded run gets what its guard told in its time, and no other's."""

from dataclasses import replace

from demo_runs import BEGAN, PROPOSED, guard_event, make_run

from rtron.demos.cases import GR
from rtron.demos.experiment.study import with_verdicts
from rtron.demos.metrics.case_run import Variant
from rtron.demos.metrics.message_journal import Attack

NAMED = {"topic": "/cmd_vel", "flow": "flow2", "publisher": GR.attacker, "decision": "drop"}


def test_what_was_told_in_its_time_is_its_own(tmp_path):
    plan = tmp_path / "rtron.yaml"
    plan.write_text(PROPOSED)
    run = make_run(Variant.GUARDED, events=(), mitigated_after=None)
    events = [guard_event(BEGAN + at, **NAMED) for at in (-1, 3.5, 300)]
    found = with_verdicts(run, GR, events, plan)
    assert found.events == (events[1],)
    assert abs(found.mitigated_after - 1.0) < 1e-6
    assert found.publishers["/cmd_vel", "flow2"] == "/stranger"
    late = with_verdicts(run, GR, events[2:], plan)
    assert (late.mitigation, late.mitigated_after) == ("nothing arrived", None)
    unharmed = replace(run, attack=Attack())
    assert with_verdicts(unharmed, GR, events, plan).mitigated_after is None
    early = [guard_event(BEGAN, **NAMED)]
    assert with_verdicts(run, GR, early, plan).mitigated_after == 0.0
