"""Whom the guard knows of a crowd on one topic: nobody who is known is pushed out of it."""

from itertools import chain

from rtron.guard.transport.ros2.crowd import MOST, MOST_OF_ONE, to_know


def ends(participant, count):
    """Return endpoints of a participant, by their GIDs; those of a lower one come first."""
    who = participant.to_bytes(12, "big")
    return [who + n.to_bytes(4, "big") for n in range(count)]


def crowd(participants, each=1, first=0):
    return list(chain.from_iterable(ends(first + n, each) for n in range(participants)))


NAV = ends(1 << 40, 3)


def test_all_are_known_while_they_are_few_by_their_gids():
    few = [*NAV, *crowd(MOST - 3)]
    assert to_know(few, ()) == [*crowd(MOST - 3), *NAV]


def test_a_crowd_is_cut():
    assert to_know(crowd(5000), ()) == crowd(MOST)


def test_who_is_known_stays_whoever_comes():
    for others in (crowd(1, 5000), crowd(5000), crowd(100, 50)):
        found = to_know([*others, *NAV], NAV)
        assert len(found) == MOST
        assert set(NAV) <= set(found)


def test_who_is_known_stays_look_by_look():
    known = to_know(NAV, ())
    for number in range(1, 20):
        known = to_know([*crowd(40 * number), *NAV], known)
    assert set(NAV) <= set(known)


def test_a_single_participant_keeps_nobody_out_though_it_came_first():
    flood = ends(0, 5000)
    known = to_know(flood, ())
    assert len(known) == MOST
    found = to_know([*flood, *NAV], known)
    assert set(NAV) <= set(found)
    assert set(flood[:MOST_OF_ONE]) <= set(found)


def test_the_share_of_a_participant_is_of_those_that_are_known_first():
    mine = ends(0, 50)
    late = mine[20 : 20 + MOST_OF_ONE]
    found = to_know([*mine, *crowd(MOST, first=1)], late)
    assert set(late) <= set(found)
    assert len(set(mine) & set(found)) == MOST_OF_ONE


def test_who_has_left_is_known_no_more():
    assert to_know(crowd(300), NAV) == crowd(MOST)
