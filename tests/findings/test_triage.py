"""What is news in a scan: by ignores, comments and a baseline."""

from dataclasses import replace

from finding_graphs import BASE, TWO_DRIVERS, small_graph

from rtron.findings import app_facts, find_findings
from rtron.findings.triage import at_level, triage
from rtron.risks import discover_risks
from rtron.vocabulary import Baseline, Evidence, FindingLevel, Ignore

GRAPH = small_graph(TWO_DRIVERS + BASE)
FOUND, RISKS = find_findings(app_facts(GRAPH)), discover_risks(GRAPH).risks
(CMD_VEL,) = FOUND
HERE = Evidence(file="rtron.toml", line=1)


def ignore(rule="several_publishers", **changes):
    return Ignore(**{"rule": rule, "reason": "a switch", "place": HERE, **changes})


def comment(file, line, **changes):
    return ignore(place=Evidence(file=file, line=line), is_comment=True, **changes)


def at_line(finding, file, line):
    return replace(finding, evidence=(Evidence(file=file, line=line),))


def test_without_ignores_and_baseline_all_is_news():
    result = triage(GRAPH, FOUND, RISKS)
    assert (result.findings, result.risks, result.ignored, result.known) == (FOUND, RISKS, (), ())


def test_an_ignore_takes_its_finding_and_the_risks_on_the_same_topics():
    mine = ignore(topic="/cmd_*")
    result = triage(GRAPH, FOUND, RISKS, [mine])
    assert (result.findings, result.ignored, result.unused) == ((), ((CMD_VEL, mine),), ())
    assert RISKS
    assert result.risks == ()


def test_an_ignore_of_another_rule_or_topic_is_unused():
    others = [ignore("qos_mismatch"), ignore(topic="/odom"), ignore(topic="/cmd_ve?2")]
    result = triage(GRAPH, FOUND, RISKS, others)
    assert (result.findings, list(result.unused)) == (FOUND, others)


def test_a_risk_of_the_paper_is_ignored_by_its_own_rule():
    result = triage(GRAPH, FOUND, RISKS, [ignore(RISKS[0].rule, topic="/cmd_vel")])
    assert (result.findings, result.unused) == (FOUND, ())
    assert RISKS[0] not in result.risks


def test_a_comment_ignores_in_its_line_and_the_next_one():
    for comment_line, line, is_ignored in (
        (7, 7, True),
        (7, 8, True),
        (7, 9, False),
        (8, 7, False),
    ):
        found = [at_line(CMD_VEL, "a.py", line)]
        result = triage(GRAPH, found, (), [comment("a.py", comment_line)])
        assert bool(result.ignored) is is_ignored, (comment_line, line)
    assert triage(GRAPH, found, (), [comment("b.py", 9)]).ignored == ()


def test_a_comment_in_a_strangers_code_silences_nothing():
    strange = small_graph(TWO_DRIVERS.replace("teleop own", "teleop third_party") + BASE)
    (finding,) = find_findings(app_facts(strange))
    mine = comment("a.py", 7)
    result = triage(strange, [at_line(finding, "a.py", 7)], (), [mine])
    assert (len(result.findings), result.unused) == (1, (mine,))


def test_a_comment_silences_nothing_that_names_no_node():
    nameless = replace(at_line(CMD_VEL, "a.launch", 7), nodes=())
    assert triage(GRAPH, [nameless], (), [comment("a.launch", 7)]).ignored == ()


def test_a_baseline_parts_new_from_known_and_tells_what_is_gone():
    known = Baseline({CMD_VEL.fingerprint: CMD_VEL.id, "00": "no_server:/x"}, frozenset())
    result = triage(GRAPH, FOUND, RISKS, (), known)
    assert (result.findings, result.known, result.gone) == ((), FOUND, ("no_server:/x",))
    fresh = triage(GRAPH, FOUND, RISKS, (), Baseline({}, frozenset(r.id for r in RISKS)))
    assert (fresh.findings, fresh.risks) == (FOUND, ())


def test_an_ignored_finding_of_the_baseline_is_not_gone():
    known = Baseline({CMD_VEL.fingerprint: CMD_VEL.id}, frozenset())
    assert triage(GRAPH, FOUND, RISKS, [ignore()], known).gone == ()


def test_a_level_shows_its_findings_new_and_known():
    odd = replace(CMD_VEL, level=FindingLevel.PEDANTIC)
    result = triage(GRAPH, [odd], (), (), Baseline({odd.fingerprint: odd.id}, frozenset()))
    assert at_level(result, FindingLevel.REGULAR).known == ()
    assert at_level(result, FindingLevel.PEDANTIC).known == (odd,)


def of_one_cause():
    """Return two findings that one namespace too much makes."""
    return [
        replace(CMD_VEL, subject=f"/r/{name}", meant=f"/{name}", topics=(f"/r/{name}",))
        for name in ("cmd_vel", "arm")
    ]


def test_an_ignore_of_one_finding_leaves_the_other_of_its_cause():
    first, other = of_one_cause()
    result = triage(GRAPH, [first, other], (), [ignore(topic="/r/cmd_vel")])
    assert (result.findings, [each for each, _ in result.ignored]) == ((other,), [first])
    assert result.folds == {}


def test_what_is_left_of_one_cause_is_no_news():
    first, other = of_one_cause()
    both = Baseline({each.fingerprint: each.id for each in (first, other)})
    assert triage(GRAPH, [first, other], (), (), both).folds == {other.id: first.id}
    for left, mended in ((first, other), (other, first)):
        result = triage(GRAPH, [left], (), (), both)
        assert (result.findings, result.known, result.gone) == ((), (left,), (mended.id,))
