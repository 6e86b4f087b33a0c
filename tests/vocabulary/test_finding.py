"""A finding is one of an app: its id, and the fingerprint that outlives moved lines."""

from dataclasses import replace

from rtron.vocabulary import Certainty, Consequence, Evidence, Finding, FindingLevel, Severity

FINDING = Finding(
    rule="several_publishers",
    subject="/cmd_vel",
    summary="/a and /b both drive the robot on /cmd_vel",
    cause="no arbiter stands between them",
    remedy="put a GRCN before /cmd_vel",
    consequence=Consequence.MOTION,
    certainty=Certainty.CERTAIN,
    severity=Severity.HIGH,
    level=FindingLevel.REGULAR,
    nodes=("/a", "/b"),
    topics=("/cmd_vel",),
    evidence=(Evidence(file="a.py", line=3),),
)


def test_the_id_is_the_rule_and_the_subject():
    assert FINDING.id == "several_publishers:/cmd_vel"


def test_the_fingerprint_stays_when_lines_and_words_change():
    moved = replace(
        FINDING,
        evidence=(Evidence(file="a.py", line=30),),
        summary="in other words",
        nodes=("/b", "/a"),
    )
    assert len(FINDING.fingerprint) == 16
    assert moved.fingerprint == FINDING.fingerprint


def test_the_fingerprint_changes_with_rule_subject_nodes_and_topics():
    others = [
        replace(FINDING, rule="open_command"),
        replace(FINDING, subject="/cmd_vel2"),
        replace(FINDING, nodes=("/a", "/c")),
        replace(FINDING, topics=("/cmd_vel", "/other")),
    ]
    assert len({each.fingerprint for each in (FINDING, *others)}) == 5
