"""Whom the guard knows of a crowd on one topic: nobody who is known is pushed out of it."""

from itertools import chain

from rtron.guard.transport.ros2.participants import (
    MAX_ENDPOINTS,
    MAX_PER_PARTICIPANT,
    select_endpoints,
)


def ends(participant, count):
    """Return endpoints of a participant, by their GIDs; those of a lower one come first."""
    who = participant.to_bytes(12, "big")
    return [who + n.to_bytes(4, "big") for n in range(count)]


def crowd(participants, each=1, first=0):
    return list(chain.from_iterable(ends(first + n, each) for n in range(participants)))


NAV = ends(1 << 40, 3)


def test_all_are_known_while_they_are_few_by_their_gids():
    few = [*NAV, *crowd(MAX_ENDPOINTS - 3)]
    assert select_endpoints(few, ()) == [*crowd(MAX_ENDPOINTS - 3), *NAV]


def test_a_crowd_is_cut():
    assert select_endpoints(crowd(5000), ()) == crowd(MAX_ENDPOINTS)


def test_who_is_known_stays_whoever_comes():
    for others in (crowd(1, 5000), crowd(5000), crowd(100, 50)):
        found = select_endpoints([*others, *NAV], NAV)
        assert len(found) == MAX_ENDPOINTS
        assert set(NAV) <= set(found)


def test_who_is_known_stays_look_by_look():
    known = select_endpoints(NAV, ())
    for number in range(1, 20):
        known = select_endpoints([*crowd(40 * number), *NAV], known)
    assert set(NAV) <= set(known)


def test_a_single_participant_keeps_nobody_out_though_it_came_first():
    flood = ends(0, 5000)
    known = select_endpoints(flood, ())
    assert len(known) == MAX_ENDPOINTS
    found = select_endpoints([*flood, *NAV], known)
    assert set(NAV) <= set(found)
    assert set(flood[:MAX_PER_PARTICIPANT]) <= set(found)


def test_the_share_of_a_participant_is_of_those_that_are_known_first():
    mine = ends(0, 50)
    late = mine[20 : 20 + MAX_PER_PARTICIPANT]
    found = select_endpoints([*mine, *crowd(MAX_ENDPOINTS, first=1)], late)
    assert set(late) <= set(found)
    assert len(set(mine) & set(found)) == MAX_PER_PARTICIPANT


def test_who_has_left_is_known_no_more():
    assert select_endpoints(crowd(300), NAV) == crowd(MAX_ENDPOINTS)
