from rtron.policies.goals.goal_tracker import GoalTracker


def following(*seen):
    made = GoalTracker()
    made.update_goals(seen)
    made.expect_goal("flow1")
    return made


def test_the_goal_that_appears_next_is_followed():
    made = following(b"old")
    assert (made.flow, made.goal) == ("flow1", None)
    made.update_goals([b"old"])
    assert made.goal is None
    made.update_goals([b"old", b"new"])
    assert made.goal == b"new"
    made.update_goals([b"old", b"new", b"newer"])
    assert made.goal == b"new"


def test_it_is_over_once():
    made = following()
    made.add_goal(b"new")
    assert not made.finish_goal(b"another")
    assert made.finish_goal(b"new")
    assert made.goal is None
    assert not made.finish_goal(b"new")


def test_a_goal_may_be_over_before_it_was_seen():
    assert following(b"old").finish_goal(b"quick")


def test_a_goal_that_was_there_before_is_not_it():
    made = following(b"old")
    assert not made.finish_goal(b"old")
    assert made.goal is None


def test_nothing_is_followed_that_was_not_expected():
    made = GoalTracker()
    made.add_goal(b"any")
    assert made.goal is None
    assert not made.finish_goal(b"any")


def test_what_is_said_next_is_followed_in_its_place():
    made = following()
    made.add_goal(b"first")
    made.expect_goal("flow2")
    assert (made.flow, made.goal) == ("flow2", None)
    assert not made.finish_goal(b"first") or made.goal is None


def test_what_does_not_appear_is_given_up():
    made = following()
    assert made.is_expecting
    made.stop_expecting()
    made.add_goal(b"late")
    assert (made.is_expecting, made.goal) == (False, None)


def test_what_has_appeared_is_expected_no_more():
    made = following()
    made.add_goal(b"new")
    assert not made.is_expecting
