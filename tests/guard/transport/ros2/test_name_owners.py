"""Whose a node name is in ROS 2, where two may have one."""

from rtron.guard.transport.ros2.participants import NameOwners

ONE, TWO = b"participant1", b"participant2"


def after(*looks):
    owners = NameOwners()
    for look in looks:
        owners.update(look)
    return owners


def test_a_name_is_its_first_participants():
    owners = after([("/nav", ONE)], [("/nav", ONE), ("/nav", TWO)])
    assert owners.is_owner("/nav", ONE)
    assert not owners.is_owner("/nav", TWO)


def test_the_second_has_it_once_the_first_has_left():
    owners = after([("/nav", ONE)], [("/nav", ONE), ("/nav", TWO)], [("/nav", TWO)])
    assert owners.is_owner("/nav", TWO)
    assert not owners.is_owner("/nav", ONE)


def test_of_two_who_come_at_once_neither_has_it_until_one_leaves():
    both = [("/nav", ONE), ("/nav", TWO)]
    owners = after(both, both)
    assert not owners.is_owner("/nav", ONE)
    assert not owners.is_owner("/nav", TWO)
    owners.update([("/nav", TWO)])
    assert owners.is_owner("/nav", TWO)


def test_a_participant_may_have_many_nodes_and_each_many_endpoints():
    owners = after([("/nav", ONE), ("/nav", ONE), ("/map", ONE), ("/teleop", TWO)])
    assert owners.is_owner("/nav", ONE)
    assert owners.is_owner("/map", ONE)
    assert owners.is_owner("/teleop", TWO)
    assert not owners.is_owner("/teleop", ONE)


def test_nobody_has_no_name_or_one_that_is_not_there():
    owners = after([("", ONE)])
    assert not owners.is_owner("", ONE)
    assert not owners.is_owner("/nav", ONE)


def test_who_has_left_and_come_back_after_another_has_it_no_more():
    owners = after([("/nav", ONE)], [("/nav", TWO)], [("/nav", ONE), ("/nav", TWO)])
    assert owners.is_owner("/nav", TWO)
    assert not owners.is_owner("/nav", ONE)


def test_a_name_that_the_domain_takes_away_is_still_its_owners():
    owners = after([("/nav", ONE)], [("", ONE), ("/nav", TWO)])
    assert owners.is_owner("/nav", ONE)
    assert not owners.is_owner("/nav", TWO)


def test_before_the_graph_has_settled_a_name_that_two_have_is_nobodys():
    owners = NameOwners()
    owners.update([("/nav", TWO)], is_settled=False)
    assert owners.is_owner("/nav", TWO)
    owners.update([("/nav", TWO), ("/nav", ONE)], is_settled=False)
    assert not owners.is_owner("/nav", ONE)
    assert not owners.is_owner("/nav", TWO)
    owners.update([("/nav", TWO), ("/nav", ONE)])
    assert not owners.is_owner("/nav", TWO)
    owners.update([("/nav", ONE)])
    assert owners.is_owner("/nav", ONE)
