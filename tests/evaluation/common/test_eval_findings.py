"""How the verdicts of readers are counted, and when a finding names a bug."""

import pytest

from evaluation.common.datasets import MissingDatasetError
from evaluation.common.findings import naming, scan, verdict_counts

SHOWN = {"a": ["r:/1", "r:/2"], "b": ["r:/1"], "c": []}


def finding(subject, rule="unmatched_topic"):
    return {"id": f"{rule}:{subject}", "subject": subject}


def test_each_shown_finding_counts_once_and_one_without_a_verdict_is_unjudged():
    verdicts = {"a": {"r:/1": "useful", "r:/9": "false"}, "b": {"r:/1": "noise"}}
    assert verdict_counts(SHOWN, verdicts) == {"useful": 1, "noise": 1, "unjudged": 1}
    assert verdict_counts(SHOWN, {}) == {"unjudged": 3}


@pytest.mark.parametrize(
    ("buggy", "fixed", "names"),
    [
        (["/imu"], [], ["unmatched_topic:/imu"]),
        (["/imu"], ["/imu"], []),
        (["/other"], [], []),
        ([], ["/imu"], []),
        (["/imu", "/other"], ["/other"], ["unmatched_topic:/imu"]),
    ],
)
def test_a_bug_is_named_by_a_finding_that_the_fix_has_not(buggy, fixed, names):
    found = [list(map(finding, each)) for each in (buggy, fixed)]
    assert naming(*found, names=["/imu"]) == names


def test_another_rule_on_the_same_name_is_another_finding():
    assert naming([finding("/imu", "type_mismatch")], [finding("/imu")], names=["/imu"])


def test_an_app_that_cannot_be_scanned_is_told(tmp_path):
    with pytest.raises(MissingDatasetError, match="gone"):
        scan(tmp_path, ["gone.json"])
