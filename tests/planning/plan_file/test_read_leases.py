"""Leases in a plan file: read, written, and refused with their line."""

import re
from pathlib import Path

import pytest

from rtron.errors import PlanError
from rtron.planning import parse_plan, write_plan
from rtron.vocabulary import SECOND, CommanderRank, LeaseGroup, PolicyName, StopButton, StopSources

PAGE = Path(__file__).parents[3] / "docs" / "leases.md"
EXAMPLE, SERVED_EXAMPLE = re.findall(
    r"```yaml\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL
)


STOP_PAGE = PAGE.with_name("stop.md")
STOP_EXAMPLE = re.search(r"```yaml\n(.*?)```", STOP_PAGE.read_text(encoding="utf-8"), re.DOTALL)[1]


def changed(before, after):
    assert before in EXAMPLE
    return EXAMPLE.replace(before, after)


def test_the_example_of_the_docs_is_a_plan():
    plan = parse_plan(EXAMPLE)
    assert plan.leases == (LeaseGroup(name="base", ttl=5 * SECOND),)
    (base,) = plan.grcn
    assert (base.policy, base.lease) == (PolicyName.LEASE, "base")
    assert [flow.rank for flow in base.flows] == list(CommanderRank)[1:]


def test_what_is_left_out_is_the_lowest_rank_and_five_seconds():
    plan = parse_plan(changed(", rank: operator_on_site", "").replace(", ttl: 5 s", ""))
    assert plan.grcn[0].flows[0].rank is CommanderRank.AGENT
    assert plan.leases[0].ttl == 5 * SECOND


def test_it_is_written_as_it_is_read():
    plan = parse_plan(changed("ttl: 5 s", "ttl: 20 s"))
    text = write_plan(plan)
    assert "  - {name: base, ttl: 20 s}\n" in text
    assert "rank: agent" not in text
    assert parse_plan(text) == plan


def test_people_at_the_service_only_look_unless_the_plan_gives_them_a_rank():
    assert parse_plan(EXAMPLE).leases[0].service is None
    plan = parse_plan(changed("leases:\n  - {name: base, ttl: 5 s}\n", SERVED_EXAMPLE))
    rank = CommanderRank.REMOTE_OPERATOR
    assert plan.leases == (LeaseGroup(name="base", ttl=60 * SECOND, service=rank),)
    assert "  - {name: base, ttl: 60 s, service: remote_operator}\n" in write_plan(plan)
    assert parse_plan(write_plan(plan)) == plan


def test_the_example_of_the_stop_is_a_part_of_a_plan():
    plan = parse_plan(EXAMPLE + STOP_EXAMPLE)
    button = StopButton(
        name="red_button", topic="/estop", publisher="/estop_driver", silent_after=SECOND
    )
    assert plan.stop_sources == StopSources(buttons=(button,), second_person=60 * SECOND)
    assert parse_plan(write_plan(plan)) == plan


@pytest.mark.parametrize(
    ("before", "after", "message"),
    [
        ("ttl: 5 s", "service: boss", "unknown word 'boss': choose from"),
        ("rank: autonomy", "rank: autonmy", "unknown word 'autonmy': did you mean autonomy?"),
        ("lease: base", "lease: bse", "no lease is called bse: did you mean base?"),
        ("    lease: base\n", "", "Lease needs a lease: say `lease: NAME` on /cmd_vel"),
        ("ttl: 5 s", "ttl: 0.4 s", "ttl: '0.4 s' is not between 0.5 s and 3600 s"),
        ("ttl: 5 s", "ttl: 2 h", "ttl: '2 h' is not between 0.5 s and 3600 s"),
        ("/teleop,", '"/teleop_*",', "Lease needs the full name of /teleop_*"),
        ("mode: enforce", "mode: observe", "Lease on /cmd_vel needs `mode: enforce`"),
        ("    type: geometry_msgs/Twist\n", "", "of a type that is not named"),
    ],
)
def test_what_is_wrong_is_told_with_its_line(before, after, message):
    with pytest.raises(PlanError, match=re.escape(message)) as raised:
        parse_plan(changed(before, after))
    assert re.search(r"rtron\.yaml:[0-9]+: ", str(raised.value))
