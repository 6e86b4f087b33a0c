"""The result of an audit: closed, open, or not known, and what the plan leaves unguarded."""

import pytest
from plans import grcn, plan_of

from rtron.vocabulary import Mode
from rtron.vocabulary.verification import GuardedPath, PathState, Verification, accepted_paths

CLOSED, OPEN, DRIFT, UNKNOWN, NOT_RUNNING = PathState


def verification(*states, problems=()):
    paths = (GuardedPath(topic="/t", private="/p", node="/n", state=each) for each in states)
    return Verification(paths=tuple(paths), problems=problems, unguarded=())


@pytest.mark.parametrize(
    ("states", "is_closed", "is_conclusive"),
    [
        ((CLOSED, NOT_RUNNING), True, True),
        ((CLOSED, OPEN), False, True),
        ((DRIFT, UNKNOWN), False, True),
        ((CLOSED, UNKNOWN), False, False),
    ],
)
def test_the_verdict_of_paths(states, is_closed, is_conclusive):
    found = verification(*states)
    assert (found.is_closed, found.is_conclusive) == (is_closed, is_conclusive)


def test_a_problem_beside_the_paths_is_conclusive():
    found = verification(CLOSED, UNKNOWN, problems=("the guard is not there",))
    assert (found.is_closed, found.is_conclusive) == (False, True)


def test_what_the_plan_leaves_unguarded():
    observed = grcn("/seen", ["/a"], ["/b"], mode=Mode.OBSERVE)
    plan = plan_of(observed, grcn("/t", ["/a"], ["/b"]), accept_unenforceable=("/x",))
    assert [each.what for each in accepted_paths(plan)] == ["/seen", "/x"]
