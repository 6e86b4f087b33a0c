from rtron.policies.goals.goal_tracker import Following


def following(*seen):
    made = Following()
    made.sees(seen)
    made.said("flow1")
    return made


def test_the_goal_that_appears_next_is_followed():
    made = following(b"old")
    assert (made.flow, made.goal) == ("flow1", None)
    made.sees([b"old"])
    assert made.goal is None
    made.sees([b"old", b"new"])
    assert made.goal == b"new"
    made.sees([b"old", b"new", b"newer"])
    assert made.goal == b"new"


def test_it_is_over_once():
    made = following()
    made.appears(b"new")
    assert not made.over(b"another")
    assert made.over(b"new")
    assert made.goal is None
    assert not made.over(b"new")


def test_a_goal_may_be_over_before_it_was_seen():
    assert following(b"old").over(b"quick")


def test_a_goal_that_was_there_before_is_not_it():
    made = following(b"old")
    assert not made.over(b"old")
    assert made.goal is None


def test_nothing_is_followed_that_was_not_expected():
    made = Following()
    made.appears(b"any")
    assert made.goal is None
    assert not made.over(b"any")


def test_what_is_said_next_is_followed_in_its_place():
    made = following()
    made.appears(b"first")
    made.said("flow2")
    assert (made.flow, made.goal) == ("flow2", None)
    assert not made.over(b"first") or made.goal is None


def test_what_does_not_appear_is_given_up():
    made = following()
    assert made.expecting
    made.give_up()
    made.appears(b"late")
    assert (made.expecting, made.goal) == (False, None)


def test_what_has_appeared_is_expected_no_more():
    made = following()
    made.appears(b"new")
    assert not made.expecting
