"""Findings of one cause are one, which tells of the others."""

import pytest

from rtron.findings.folding import fold, folds
from rtron.findings.rule import make_finding
from rtron.vocabulary import Certainty, Consequence, FindingLevel


def finding(subject, meant="", rule="unmatched_topic", certainty=Certainty.LIKELY):
    return make_finding(
        rule,
        subject,
        summary=subject,
        cause="so",
        remedy="mend",
        consequence=Consequence.FAILURE,
        certainty=certainty,
        meant=meant,
        nodes=(f"/node{subject}",),
        topics=(subject, meant) if meant else (),
    )


def folded(*pairs):
    """Return the subjects that are left, each with its cause."""
    return [(each.subject, each.cause) for each in fold(finding(*pair) for pair in pairs)]


def test_a_namespace_too_much_is_told_once():
    pairs = [("/r/r/order", "/r/order"), ("/a", "/b"), ("/r/state", "/r/r/state")]
    expected = [("/r/r/order", "so; the same parts /r/state from /r/r/state"), ("/a", "so")]
    assert folded(*pairs) == expected
    first, _ = fold(finding(*pair) for pair in pairs)
    assert first.remedy.startswith("give the nodes one namespace")
    assert first.nodes == ("/node/r/r/order", "/node/r/state")
    assert first.topics == ("/r/r/order", "/r/order", "/r/state", "/r/r/state")


def test_a_service_and_a_command_have_the_same_cause():
    pairs = [("/go", "/r/go", "no_server"), ("/cmd_vel", "/r/cmd_vel", "lost_command")]
    assert [subject for subject, _ in folded(*pairs)] == ["/go"]


@pytest.mark.parametrize(
    "pairs",
    [
        [("/r1/scan", "/scan"), ("/r2/image", "/image")],
        [("/scan", "/scans"), ("/scan2", "/scans2")],
        [("/r/scan", "/scan"), ("r/laser", "laser")],
        [("/scan",), ("/image",)],
        [("/cmd_vel", "/r1/cmd_vel"), ("/r2/cmd_vel", "/cmd_vel")],
    ],
)
def test_what_differs_otherwise_has_a_cause_of_its_own(pairs):
    assert len(folded(*pairs)) == 2


def test_frames_with_one_prefix_are_told_once_and_keep_their_remedy():
    pairs = [("r/odom", "odom"), ("r/base", "base"), ("laser_1", "laser"), ("imu_1", "imu")]
    found = fold(finding(*pair, rule="stray_frame") for pair in pairs)
    assert [each.subject for each in found] == ["r/odom", "laser_1"]
    assert {each.remedy for each in found} == {"mend"}


def test_what_a_level_hides_is_not_folded_into_what_it_shows():
    possible = finding("/r/image", "/image", certainty=Certainty.POSSIBLE)
    found = fold([finding("/r/scan", "/scan"), possible])
    assert [each.level for each in found] == [FindingLevel.REGULAR, FindingLevel.PEDANTIC]


def test_each_finding_knows_which_one_tells_of_it():
    pairs = [("/r/scan", "/scan"), ("/a", "/b"), ("/r/image", "/image")]
    under = folds(finding(*pair) for pair in pairs)
    assert under == {"unmatched_topic:/r/image": "unmatched_topic:/r/scan"}


def test_no_finding_tells_of_itself():
    pairs = [("/r/scan", "/scan"), ("/r/scan", "/scan"), ("/r/image", "/image")]
    under = folds(finding(*pair) for pair in pairs)
    assert under == {"unmatched_topic:/r/image": "unmatched_topic:/r/scan"}
