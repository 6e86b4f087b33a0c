"""How severe a finding is, and who sees it."""

import pytest
from finding_graphs import BASE, FIRMWARE, MUX, TWIST, TWO_DRIVERS, parameters, small_graph

from rtron.findings import app_facts, find_findings, shown_at
from rtron.findings.rule import make_finding
from rtron.findings.severity import level_of, severity_of
from rtron.vocabulary import Certainty, Consequence, FindingLevel, Severity

MOTION, FAILURE, ODDITY = Consequence
CERTAIN, LIKELY, POSSIBLE = Certainty
REGULAR, PEDANTIC, AUDITOR = FindingLevel


@pytest.mark.parametrize(
    ("consequence", "certainty", "severity"),
    [
        (MOTION, CERTAIN, Severity.HIGH),
        (MOTION, LIKELY, Severity.HIGH),
        (MOTION, POSSIBLE, Severity.MEDIUM),
        (FAILURE, CERTAIN, Severity.MEDIUM),
        (FAILURE, LIKELY, Severity.MEDIUM),
        (FAILURE, POSSIBLE, Severity.LOW),
        (ODDITY, CERTAIN, Severity.LOW),
        (ODDITY, LIKELY, Severity.LOW),
        (ODDITY, POSSIBLE, Severity.LOW),
    ],
)
def test_the_table(consequence, certainty, severity):
    assert severity_of(consequence, certainty) is severity
    assert made(consequence, certainty).severity is severity
    assert made(consequence, certainty).level is level_of(severity)


def made(consequence, certainty, **keys):
    words = {"summary": "s", "cause": "c", "remedy": "r"}
    return make_finding("r", "/x", consequence=consequence, certainty=certainty, **words, **keys)


def test_what_is_mild_is_for_the_pedantic():
    levels = [level_of(severity) for severity in (Severity.LOW, Severity.MEDIUM, Severity.HIGH)]
    assert levels == [PEDANTIC, REGULAR, REGULAR]


def test_a_rule_may_choose_another_level():
    assert made(MOTION, CERTAIN, level=AUDITOR).level is AUDITOR


def test_each_level_shows_those_before_it_too():
    shown = {
        level: [
            other for other in FindingLevel if shown_at(level, made(MOTION, CERTAIN, level=other))
        ]
        for level in FindingLevel
    }
    assert shown == {
        REGULAR: [REGULAR],
        PEDANTIC: [REGULAR, PEDANTIC],
        AUDITOR: [REGULAR, PEDANTIC, AUDITOR],
    }


def test_names_and_places_stand_once_in_their_order():
    finding = made(MOTION, CERTAIN, nodes=["/b", "/a", "/b"], topics=iter(["/x", "/x"]))
    assert (finding.nodes, finding.topics) == (("/b", "/a"), ("/x",))


@pytest.mark.parametrize(
    ("more", "unread", "certainty"),
    [(BASE, (), CERTAIN), (FIRMWARE, ("/firmware",), LIKELY), ("", (), LIKELY)],
    ids=["reader known", "a node not read", "nobody"],
)
def test_two_drivers_are_certain_with_a_reader_and_likely_without(more, unread, certainty):
    for trust, severity in (("own", Severity.MEDIUM), ("third_party", Severity.HIGH)):
        drivers = TWO_DRIVERS.replace(" own", f" {trust}", 1)
        (finding,) = find_findings(app_facts(small_graph(drivers + more, unread=unread)))
        assert (finding.certainty, finding.severity) == (certainty, severity)
        assert finding.level is REGULAR


@pytest.mark.parametrize("unread", [(), ("/firmware",)])
def test_an_open_command_is_only_possible_and_for_auditors(unread):
    (finding,) = find_findings(app_facts(small_graph(BASE + FIRMWARE, unread=unread)))
    assert (finding.certainty, finding.level) == (POSSIBLE, AUDITOR)
    assert finding.severity is Severity.MEDIUM


def test_the_worst_comes_first_and_one_rule_in_order_of_subject():
    text = "/z rosbridge_server own\n/b rosbridge_server own\n/n n own\n sub /lost a_msgs/msg/B\n"
    graph = small_graph(
        text + TWO_DRIVERS + MUX.replace("/cmd_vel", "/mux_vel"),
        parameters=parameters("use_sim_time", n=True, b=False),
    )
    assert [(each.id, str(each.severity)) for each in find_findings(app_facts(graph))] == [
        ("network_bridge:/b", "high"),
        ("network_bridge:/z", "high"),
        ("several_publishers:/cmd_vel", "medium"),
        ("open_command:/joy_vel", "medium"),
        ("sim_time:use_sim_time", "medium"),
        ("incomplete_launch:/lost", "low"),
        ("arbiter:/twist_mux", "low"),
    ]


def test_twist_in_ros_1_spelling_is_the_same_command():
    graph = small_graph(TWO_DRIVERS.replace(TWIST, "geometry_msgs/Twist") + BASE, ros=1)
    assert [each.id for each in find_findings(app_facts(graph))] == ["several_publishers:/cmd_vel"]
