"""Rules that somebody whom they block can lift, or a node that fails, and costly expressions."""

import pytest

from rtron.messages.expressions.python_terms import macro_depth
from rtron.planning import parse_plan
from rtron.workflows.check_plan import check

PLAN = """\
grcn:
  - topic: /cmd_vel
    type: geometry_msgs/Twist
    mode: {mode}
    policy: Preemption
    flows:
      - {{name: teleop, publisher: /teleop, priority: 2}}
      - {{name: nav, publisher: /nav, priority: 1}}
    successors: [/base]
msrcn:
  mode: {mode}
  eflows:
    - {{name: low, topic: /bat, publisher: {publisher}, present: 5 s{unknown}}}
    - {{name: near, topic: /people, publisher: {scanner}, present: 1 s}}
  aflows:
    - topic: /cmd_vel
      type: geometry_msgs/Twist
      flows: [{{name: a1, publisher: /teleop}}]
      successors: [/base]
  rules: [{{name: battery, when: {when}, block: [{block}]}}]
"""
USUAL = {
    "mode": "enforce",
    "publisher": "/bms",
    "scanner": "/scanner",
    "unknown": "",
    "when": "low",
    "block": "/cmd_vel",
}
SILENT = "while /bms is silent, this blocks nothing: leave `on_silence` out, then it blocks"
ERROR = (
    "while /bms says what cannot be judged, this blocks nothing: leave `on_error` out, then it "
    "blocks"
)
CLEAR = ", on_silence: clear"
OWN = "low comes from {}, which this blocks: it can lift its own block; ask another"
GAPS = [
    ({}, []),
    ({"unknown": CLEAR}, [SILENT]),
    ({"unknown": ", on_error: clear"}, [ERROR]),
    ({"unknown": ", on_silence: clear, on_error: clear"}, [SILENT, ERROR]),
    ({"unknown": ", on_silence: set"}, []),
    ({"unknown": ", on_silence: keep"}, []),
    ({"unknown": ", on_silence: block"}, []),
    ({"unknown": CLEAR, "when": "'!low'"}, []),
    ({"unknown": ", on_silence: set", "when": "'!low'"}, [SILENT]),
    ({"unknown": CLEAR, "when": "low || near"}, []),
    ({"unknown": CLEAR, "when": "low && near"}, [SILENT]),
    ({"unknown": CLEAR, "mode": "observe"}, []),
    ({"publisher": "/teleop"}, [OWN.format("/teleop")]),
    ({"publisher": "/nav"}, [OWN.format("/nav")]),
    ({"publisher": "'/na*'"}, [OWN.format("/na*")]),
    ({"publisher": "/teleop", "block": "a1"}, [OWN.format("/teleop")]),
    ({"publisher": "/nav", "block": "a1"}, []),
    ({"publisher": "/nav", "when": "low || near"}, []),
    ({"publisher": "/nav", "when": "low && near"}, [OWN.format("/nav")]),
    ({"publisher": "/nav", "mode": "observe"}, []),
]


@pytest.mark.parametrize(("settings", "gaps"), GAPS)
def test_a_rule_that_does_not_hold_when_it_should(settings, gaps):
    told = [str(each) for each in check(parse_plan(PLAN.format(**USUAL | settings)))]
    mission = [each for each in told if each.startswith("warning: MSRCN")]
    assert mission == [f"warning: MSRCN, rule battery: {gap}" for gap in gaps]


@pytest.mark.parametrize(
    ("settings", "gaps"),
    [
        ({"mode": "observe", "scanner": "'/*'"}, []),
        ({"scanner": "'/*'"}, ["every node can publish /people as /*: name one"]),
        ({"scanner": "'/*/**'"}, ["every node can publish /people as /*/**: name one"]),
        ({"scanner": "'/scan*'"}, []),
    ],
)
def test_an_event_that_anybody_can_publish(settings, gaps):
    told = [str(each) for each in check(parse_plan(PLAN.format(**USUAL | settings)))]
    assert [each for each in told if "MSRCN, eflow near" in each] == [
        f"warning: MSRCN, eflow near: {gap}" for gap in gaps
    ]


def test_rules_that_only_watch_where_a_grcn_enforces_are_told():
    text = PLAN.format(**USUAL).replace("msrcn:\n  mode: enforce", "msrcn:\n  mode: observe")
    assert [str(each) for each in check(parse_plan(text))] == [
        "warning: MSRCN: it only watches: no rule holds on /cmd_vel; set `mode: enforce`"
    ]


TWO = "event.cell_voltage.exists(a, event.cell_voltage.exists(b, a + b > 9.0))"
THREE = f"event.cell_voltage.all(x, {TWO})"


@pytest.mark.parametrize(
    ("text", "depth"),
    [
        ("event.ok", 0),
        ("(size(event.cells) > 1)", 0),
        ("exists(1)", 1),
        ("event.cells.map(c, c + 1.0).exists(c, c > 2.0)", 1),
        ("event.cells.exists(c, c > (2.0)) && event.cells.all(c, c > 1.0)", 1),
        (TWO, 2),
        (THREE, 3),
    ],
)
def test_how_deep_lists_are_gone_over(text, depth):
    assert macro_depth(text) == depth


@pytest.mark.parametrize(("when", "is_told"), [(TWO, False), (THREE, True)])
def test_an_expression_that_takes_too_many_rounds_is_told(when, is_told):
    event = f'present: 5 s, type: sensor_msgs/BatteryState, when: "{when}"'
    plan = parse_plan(PLAN.format(**USUAL).replace("present: 5 s", event))
    told = [str(each) for each in check(plan)]
    what = "of a list of over 22 elements that takes more than 10000 rounds"
    text = f"MSRCN, eflow low: `when` goes over lists 3 deep: {what}, and then it cannot be judged"
    assert told == ([f"warning: {text}"] if is_told else [])
