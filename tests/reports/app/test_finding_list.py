"""The findings as text: what a person reads of each, and how many there are."""

import pytest
from finding_cases import HIGH, LOW, MEDIUM, PLACES, TRIAGE, finding

from rtron.reports.app.scan_text import finding_list, findings_verdict, triage_notes
from rtron.reports.text_layout import Report
from rtron.vocabulary import Evidence, FindingLevel, Triage

FOUR_LINES = """\

  high    /nav and /teleop both drive the robot on /cmd_vel
          no arbiter stands between them: /base obeys whoever published last
          src/nav.py:7 and 2 more (several_publishers, certain)
          -> put a GRCN before /cmd_vel: `rtron plan` proposes it
"""
PEDANTIC = finding("/odd", level=FindingLevel.PEDANTIC)
AUDITOR = finding("/odder", level=FindingLevel.AUDITOR)


@pytest.fixture
def text_of(printed):
    return lambda *findings, **keys: printed(
        Report(lambda page: finding_list(findings, page)), **keys
    )


def test_one_finding_takes_four_lines(text_of):
    assert text_of(HIGH) == FOUR_LINES


def test_the_findings_follow_each_other_in_the_order_given(text_of):
    text = text_of(HIGH, MEDIUM, LOW)
    assert text.startswith(FOUR_LINES)
    marks = [row[2:10] for row in text.splitlines() if "both drive" in row]
    assert marks == ["high    ", "medium  ", "low     "]


@pytest.mark.parametrize(
    ("evidence", "row"),
    [
        (PLACES[:1], "src/nav.py:7"),
        (PLACES[:2], "src/nav.py:7 and 1 more"),
        ((Evidence(file="http://robot:1234"),), "http://robot:1234"),
    ],
)
def test_the_first_place_stands_with_the_number_of_others(text_of, evidence, row):
    assert (
        text_of(finding(evidence=evidence)).splitlines()[3]
        == f"          {row} (several_publishers, certain)"
    )


def test_without_a_place_the_rule_stands_alone(text_of):
    assert text_of(finding(evidence=())) == FOUR_LINES.replace("src/nav.py:7 and 2 more ", "")


def test_a_long_summary_is_wrapped_below_itself(text_of):
    rows = text_of(finding(summary="word " * 40), width=60).splitlines()[1:]
    assert rows[0].startswith("  high    word")
    assert all(len(row) <= 60 and row.startswith(" " * 10) for row in rows[1:])


def test_nothing_found_is_nothing_shown(text_of):
    assert text_of() == ""


def test_long_prose_is_wrapped_below_itself(text_of):
    rows = text_of(finding(cause="word " * 40), width=60).splitlines()
    assert all(len(row) <= 60 and row.startswith(" " * 10) for row in rows[2:])


def test_a_terminal_gets_colours_and_a_file_none(text_of):
    assert "\x1b[1;31mhigh" in text_of(HIGH, force_terminal=True, color_system="standard")
    assert "\x1b" not in text_of(HIGH)


def test_hostile_names_do_nothing(text_of):
    name = "/\x1b[2J[bold red]x[/]\n\u202e:smile:"
    words = {"summary": name, "cause": name, "remedy": name}
    text = text_of(finding(name, evidence=(Evidence(file=name, line=1),), **words))
    assert "\x1b" not in text
    assert "\u202e" not in text
    assert text.count("/\\x1b[2J[bold red]x[/]\\n\\u202e:smile:") == 4


@pytest.mark.parametrize(
    ("shown", "hidden", "words"),
    [
        ([HIGH], [], "1 finding: 1 high"),
        ([HIGH, HIGH, LOW], [], "3 findings: 2 high, 1 low"),
        ([HIGH, MEDIUM, LOW], [], "3 findings: 1 high, 1 medium, 1 low"),
        ([HIGH], [PEDANTIC], "1 finding: 1 high; 1 more from --level pedantic on"),
        ([], [AUDITOR, PEDANTIC], "no findings; 2 more from --level pedantic on"),
        ([], [AUDITOR], "no findings; 1 more from --level auditor on"),
        ([], [], "no findings"),
    ],
)
def test_the_verdict_counts_by_severity_and_tells_of_hidden_ones(shown, hidden, words):
    assert findings_verdict(shown, hidden, is_whole=True).plain == words


def test_no_findings_holds_for_what_could_be_read():
    assert (
        findings_verdict([], [], is_whole=False).plain
        == "no findings in what could be read, see below"
    )
    assert findings_verdict([], [LOW], is_whole=False).plain == (
        "no findings in what could be read, see below; 1 more from --level pedantic on"
    )
    assert findings_verdict([HIGH], [], is_whole=False).plain == "1 finding: 1 high"


NOTES = """\

Ignored
  several_publishers:/arm: one of them is a [test] rig (rtron.toml:3)
  nothing is found to ignore by no_server *, remove it (a.py:9)

Since the baseline
  1 known, not shown
  gone: no_server:/plan
"""


def test_what_is_no_news_is_told_with_its_reason(printed):
    assert printed(Report(lambda page: triage_notes(TRIAGE, page))) == NOTES
    assert printed(Report(lambda page: triage_notes(Triage(findings=(HIGH,)), page))) == ""
