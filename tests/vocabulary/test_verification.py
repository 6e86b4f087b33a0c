"""The result of an audit: closed, open, or not known, and what the plan leaves unguarded."""

from dataclasses import replace

import pytest
from plans import grcn, plan_of

from rtron.vocabulary import Mode, UnguardedPath
from rtron.vocabulary.verification import GuardedPath, PathState, Verification, unguarded_paths

CLOSED, OPEN, DRIFT, UNKNOWN, NOT_SEEN, ABSENT = PathState


def path(node, state):
    return GuardedPath(topic="/t", private="/p", node=node, state=state)


def verification(*states, problems=()):
    paths = (path("/n", each) for each in states)
    return Verification(paths=tuple(paths), problems=problems, unguarded=())


@pytest.mark.parametrize(
    ("states", "is_closed", "is_conclusive"),
    [
        ((CLOSED,), True, True),
        ((CLOSED, ABSENT), True, True),
        ((CLOSED, NOT_SEEN), False, False),
        ((NOT_SEEN,), False, False),
        ((OPEN, NOT_SEEN), False, True),
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


def test_what_was_not_seen_is_named_once():
    paths = [path("/nav", NOT_SEEN), path("/nav", NOT_SEEN), path("/driver", CLOSED)]
    found = Verification(paths=tuple(paths), problems=(), unguarded=())
    assert found.not_seen == ("/nav",)


def test_what_is_known_to_be_off_is_absent_unless_it_runs():
    paths = (path("/teleop_*", NOT_SEEN), path("/nav", DRIFT), path("/driver", NOT_SEEN))
    found = Verification(paths=paths, problems=(), unguarded=()).without(["/teleop_*", "/nav"])
    assert [each.state for each in found.paths] == [ABSENT, DRIFT, NOT_SEEN]
    assert found.not_seen == ("/driver",)


def test_what_the_plan_leaves_unguarded():
    observed = grcn("/seen", ["/a"], ["/b"], mode=Mode.OBSERVE)
    plan = plan_of(observed, grcn("/t", ["/a"], ["/b"]), accept_unenforceable=("/x",))
    left = [UnguardedPath(what=what, why="a service") for what in ("/kill", "/t")]
    running = [UnguardedPath(what=what, why="is a service") for what in ("/kill", "/own")]
    found = unguarded_paths(replace(plan, unguarded=tuple(left)), running)
    assert [each.what for each in found] == ["/seen", "/kill", "/x", "/own"]
