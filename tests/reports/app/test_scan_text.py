import re

from report_cases import CONTENDED, GRAPH, REPORT, hears, report_of, risk, speaks
from rich.cells import cell_len

from rtron.reports.app.scan_text import Scan, scan_text
from rtron.reports.app.unresolved_list import MOST_CAUSES
from rtron.vocabulary import (
    Evidence,
    FindingLevel,
    InteractionGraph,
    RiskKind,
    RiskRole,
    Severity,
    Triage,
    UnresolvedItem,
)

NO_FINDINGS = Triage(findings=())
AT_80_COLUMNS = """\
autorace  ROS 1, read from graph.json
5 nodes, 4 topics, 8 endpoints

What can move this robot
  nothing in what could be read, see below

Findings
no findings in what could be read, see below

The paper's risks
3 risks: 1 high, 1 medium, 1 low

Who can interfere with whom
  GR-ST: several nodes publish one topic (1)
  high    geometry_msgs/Twist, Control, contend
          /lane ─────────────────┐
          /parking ──────────────┼─► /cmd_vel ───► /base
          /teleop (third party) ─┘
          src/1.py:1
          src/2.py:2
          src/3.py:3 and 2 more

MSR: an action may be taken under the wrong event (2)
  medium  MSR-action:/cmd_vel  Control
          /lane and others make the robot act through /cmd_vel: /base obeys,
          whatever happens
          action: /lane, /teleop
          src/lane.py:7 and 1 more
  low     MSR-event:/detect/sign  Perception

Coordination nodes needed
  GRCN           1  Control 1
  RSRCN          1
  MSRCN          1
  fps_monitor    2

Rules not run
  rsr_image: the graph holds no message types

Not resolved (1)
  Not followed in the source (1)
    -> look at these places yourself
    a publisher of /odd: its name comes from a service call (src/odd.cpp:12)

Next
  rtron plan graph.json -o rtron.yaml  propose what to put in between
"""


def scan_of(graph=GRAPH, report=REPORT, level=FindingLevel.AUDITOR):
    next_step = "rtron plan graph.json -o rtron.yaml"
    return scan_text(
        Scan(graph, report, NO_FINDINGS, read_from="graph.json", next_step=next_step, level=level)
    )


def test_at_80_columns(printed):
    assert printed(scan_of()) == AT_80_COLUMNS


def test_prose_takes_the_width_of_the_page(printed):
    reason = "/lane and others make the robot act through /cmd_vel: /base obeys, whatever happens"
    assert reason in printed(scan_of(), width=140)
    assert reason not in printed(scan_of(), width=80)


def test_every_line_fits_the_page(printed):
    for width in (80, 100, 140):
        assert max(map(cell_len, printed(scan_of(), width=width).splitlines())) <= width


def test_severity_has_a_colour_on_a_terminal_and_none_elsewhere(printed):
    assert "\x1b[1;31mhigh" in printed(scan_of(), force_terminal=True, color_system="standard")
    assert "\x1b" not in printed(scan_of())


def test_the_worst_comes_first(printed):
    low = risk(RiskKind.GR_ST, topics=("/mild",))
    middle = risk(RiskKind.GR_ST, topics=("/middling",), severity=Severity.MEDIUM)
    text = printed(scan_of(report=report_of(low, middle, CONTENDED)))
    firsts = re.findall(r"^  (high|medium|low) ", text, re.MULTILINE)
    assert firsts == ["high", "medium", "low"]
    assert "3 risks: 1 high, 1 medium, 1 low" in text


def test_places_are_fewer_the_milder_the_risk(printed):
    evidence = tuple(Evidence(file=f"{i}.py", line=i) for i in range(1, 5))
    shown = [
        printed(scan_of(report=report_of(risk(RiskKind.MSR, severity=s, evidence=evidence))))
        for s in (Severity.HIGH, Severity.MEDIUM, Severity.LOW)
    ]
    assert [text.count(".py:") for text in shown] == [3, 1, 0]
    assert ["3.py:3 and 1 more" in shown[0], "1.py:1 and 3 more" in shown[1]] == [True, True]


def test_no_risk_is_said_with_the_doubt_that_stays(printed):
    quiet = InteractionGraph(app="quiet", endpoints=(speaks("/a", "/t"), hears("/b", "/t")))
    text = printed(scan_of(quiet, report_of()))
    assert text.startswith("quiet  ROS 1, read from graph.json\n2 endpoints\n\nWhat can move")
    assert "\n  nothing\n\nFindings\nno findings\n\n" in text
    assert text.endswith("no risks found\n")
    assert "no risks found in what could be read" in printed(scan_of(GRAPH, report_of()))
    skipped = report_of(not_run={"rsr": "why"})
    assert "no risks found in what could be read" in printed(scan_of(quiet, skipped))


def test_an_empty_graph_is_named_so(printed):
    assert "the graph is empty" in printed(scan_of(InteractionGraph(app=""), report_of()))


def test_a_long_list_of_unresolved_is_cut_and_counted(printed):
    items = tuple(UnresolvedItem(what="x", why=f"why {i}") for i in range(MOST_CAUSES + 2))
    text = printed(scan_of(InteractionGraph(app="", unresolved=items), report_of()))
    assert f"Not resolved ({MOST_CAUSES + 2})" in text
    assert "and 2 more, which --format graph lists" in text


def test_the_papers_risks_are_for_auditors(printed):
    for level in (FindingLevel.REGULAR, FindingLevel.PEDANTIC):
        text = printed(scan_of(level=level))
        assert "GR-ST" not in text
        assert "Rules not run" in text


def test_long_names_stay_whole(printed):
    name = "/" + "a_very_long_namespace/" * 8 + "node"
    found = risk(RiskKind.GR_ST, role_nodes={RiskRole.PUBLISHER: (name, "/b")}, topics=(name,))
    told = risk(RiskKind.RSR, severity=Severity.HIGH, reason=f"{name} outruns its eyes")
    rows = printed(scan_of(report=report_of(found, told))).splitlines()
    assert sum(name in row for row in rows) == 3


def test_hostile_names_do_nothing(printed):
    name = "/\x1b[2J[bold red]x[/]\n\u202e:smile:"
    found = risk(
        RiskKind.MSR,
        id=name,
        role_nodes={RiskRole.EVENT: (name,)},
        topics=(name,),
        message_type=name,
        reason=name,
        severity=Severity.HIGH,
        evidence=(Evidence(file=name),),
    )
    flow = risk(
        RiskKind.GR_ST, role_nodes={RiskRole.PUBLISHER: (name,)}, topics=(name,), successors=(name,)
    )
    graph = InteractionGraph(app=name, unresolved=(UnresolvedItem(what=name, why=name),))
    text = printed(scan_of(graph, report_of(found, flow, not_run={name: name})))
    assert "\x1b" not in text
    assert "\u202e" not in text
    assert text.count("/\\x1b[2J[bold red]x[/]\\n\\u202e:smile:") == text.count("2J") > 10
