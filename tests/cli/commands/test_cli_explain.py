import json

import pytest

from rtron.cli.commands.explain import page_names
from rtron.findings import FINDING_RULES
from rtron.policies import POLICIES
from rtron.risks import RULES


def test_every_rule_and_policy_is_listed_and_explained(rtron):
    listed = rtron("explain").out
    rules = [rule.name for rule in (*FINDING_RULES, *RULES)]
    assert page_names() == [*rules, *map(str, POLICIES)]
    for name in page_names():
        assert f"\n  {name} " in listed
        ran = rtron("explain", name)
        assert ran.code == 0
        assert ran.out.startswith("# ")


@pytest.mark.parametrize(
    ("name", "titles"),
    [
        ("several_publishers", ["# Several nodes command one motion"]),
        ("several_publishers:/cmd_vel", ["# Several nodes command one motion"]),
        ("Type-Mismatch", ["# The ends of a topic have different message types"]),
        ("GR-ST", ["# General risk with a single topic"]),
        ("gr-st", ["# General risk with a single topic"]),
        ("preemption", ["# Preemption"]),
        ("Priority-Queue", ["# Priority_Queue"]),
        ("MSR-event:/odom", ["# Mission-specific risk of an event"]),
        ("MSR", ["# Mission-specific risk of an event", "# Mission-specific risk of an action"]),
    ],
)
def test_names_are_taken_as_reports_write_them(rtron, name, titles):
    out = rtron("explain", name).out
    assert [row for row in out.splitlines() if row.startswith("# ")] == titles


def test_an_unknown_name_is_2_with_the_nearest(rtron):
    ran = rtron("explain", "MSR-evnt")
    assert (ran.code, ran.out) == (2, "")
    assert "did you mean msr_event?" in ran.err
    assert "`rtron explain` lists all" in rtron("explain", "x" * 1000).err


def test_a_terminal_gets_it_laid_out(rtron, monkeypatch):
    monkeypatch.setenv("FORCE_COLOR", "1")
    assert "# General" not in rtron("explain", "gr_st").out


@pytest.mark.parametrize(
    ("document", "title"),
    [("plan", "rtron.plan/1"), ("graph", "rtron.graph/1"), ("config", "rtron.toml")],
)
def test_schemas_are_json(rtron, document, title):
    schema = json.loads(rtron("schema", document).out)
    assert schema["title"] == title
    assert schema["additionalProperties"] is False
