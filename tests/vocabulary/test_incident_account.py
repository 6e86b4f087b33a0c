"""What an account of an incident keeps of verdicts and commanders, and what it only counts."""

from dataclasses import replace

import pytest

from rtron.vocabulary import (
    SECOND,
    IncidentAccount,
    IncidentCause,
    IncidentHeader,
    NotedChange,
    TopicAccount,
)
from rtron.vocabulary import incident as module

FIRST = 1000 * SECOND
CAUSE = IncidentCause(at=FIRST, kind="stop", topic="/cmd_vel", flow="teleop", reason="silent")
KINDS = ("intervention", "stop", "alarm", "alarm")
HEADER = IncidentHeader(
    causes=(CAUSE,),
    omitted_causes=0,
    begin=FIRST - 60 * SECOND,
    end=FIRST + 5 * SECOND,
    app="base",
    ros=1,
    revision=0,
    rtron="0.1.0",
)


def test_an_alarm_is_graver_than_what_came_before_it():
    causes = [replace(CAUSE, kind=kind, at=at) for at, kind in enumerate(KINDS)]
    assert replace(HEADER, causes=tuple(causes)).gravest.at == 2
    assert replace(HEADER, causes=tuple(causes[:2])).gravest.at == 1


def verdict(at, decision="pass", flow="teleop", policy="Block"):
    return NotedChange(at, flow, decision, policy, "")


def test_an_account_begins_before_its_first_cause():
    account = IncidentAccount(header=HEADER, topics={}, events=())
    assert account.span == (-60 * SECOND, 5 * SECOND)


def test_verdicts_are_counted_and_changes_kept():
    account = TopicAccount()
    found = [verdict(1), verdict(2), verdict(3, "drop"), verdict(4, flow="nav"), verdict(5, "drop")]
    for each in found:
        account.note_verdict(each)
    assert account.verdicts == {("teleop", "pass"): 2, ("teleop", "drop"): 2, ("nav", "pass"): 1}
    assert [each.at for each in account.changes] == [1, 3, 4]


def test_the_same_decision_of_another_policy_is_a_change():
    account = TopicAccount()
    account.note_verdict(verdict(1))
    account.note_verdict(verdict(2, policy="Constrain"))
    assert [each.policy for each in account.changes] == ["Block", "Constrain"]


def test_changes_without_end_are_counted(monkeypatch):
    monkeypatch.setattr(module, "MOST_CHANGES", 2)
    account = TopicAccount()
    for at in range(5):
        account.note_verdict(verdict(at, "drop" if at % 2 else "pass"))
    assert (len(account.changes), account.omitted_changes) == (2, 3)


@pytest.mark.parametrize("limit", [None, 0.2])
def test_commanders_and_limits_are_kept_where_they_change(limit):
    account = TopicAccount()
    teleop, nobody = ("teleop", "/teleop", ""), ("", "", "silent")
    account.note_control(1, teleop, limit)
    account.note_control(2, teleop, limit)
    account.note_control(3, nobody, limit)
    account.note_control(4, nobody, 0.5)
    assert account.owners == [(1, *teleop), (3, *nobody)]
    assert account.limits == [(1, limit), (4, 0.5)]
