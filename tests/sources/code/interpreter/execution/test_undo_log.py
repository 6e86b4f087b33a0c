"""Writes of branches that may be taken: seen by neither the other branch nor the past."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.execution.undo_log import UndoLog

A, B, C = av.Scalar("a"), av.Scalar("b"), av.Scalar("c")


def writer(trail, place, key, value, *, goes_on=True):
    def run():
        trail.set(place, key, value)
        return goes_on

    return run


def test_both_branches_begin_from_the_same_state_and_merge():
    trail, place, seen = UndoLog(), {"x": A}, []

    def branch(value):
        def run():
            seen.append(place["x"])
            trail.set(place, "x", value)
            return True

        return run

    trail.run_branches([branch(B), branch(C)], {})
    assert seen == [A, A]
    assert place == {"x": av.Choice((B, C))}


def test_a_branch_that_writes_nothing_keeps_what_was():
    trail, place = UndoLog(), {"x": A}
    trail.run_branches([writer(trail, place, "x", B), lambda: True], {})
    assert set(av.options(place["x"])) == {A, B}


def test_a_write_that_all_branches_do_alike_is_certain():
    trail, place = UndoLog(), {}
    trail.run_branches([writer(trail, place, "x", A)] * 2, {})
    assert place == {"x": A}


def test_what_only_one_branch_makes_is_kept():
    trail, place = UndoLog(), {}
    trail.run_branches([writer(trail, place, "x", A), lambda: True], {})
    assert place == {"x": A}


def test_locals_of_a_branch_that_leaves_are_forgotten_but_not_its_members():
    trail, local, member = UndoLog(), {"x": A}, {"y": A}

    def leaves():
        trail.set(local, "x", B)
        trail.set(member, "y", B)
        return False

    trail.run_branches([leaves, lambda: True], local)
    assert local == {"x": A}
    assert set(av.options(member["y"])) == {A, B}


def test_branches_inside_branches_merge_inwards_first():
    trail, place = UndoLog(), {"x": av.Scalar("d")}

    def outer():
        trail.run_branches([writer(trail, place, "x", A), writer(trail, place, "x", B)], {})
        assert set(av.options(place["x"])) == {A, B}
        return True

    trail.run_branches([outer, writer(trail, place, "x", C)], {})
    assert set(av.options(place["x"])) == {A, B, C}


def test_a_trial_leaves_no_trace_and_tells_what_it_wrote():
    trail, place = UndoLog(), {"x": A}
    writes, goes_on = trail.run_and_undo(writer(trail, place, "x", B, goes_on=False))
    assert place == {"x": A}
    assert [(key, value) for _, key, value in writes.values()] == [("x", B)]
    assert goes_on is False


def test_a_trial_that_fails_is_taken_back():
    trail, place = UndoLog(), {"x": A}

    def fails():
        trail.set(place, "x", B)
        raise ValueError

    with pytest.raises(ValueError):
        trail.run_and_undo(fails)
    assert place == {"x": A}


def test_items_added_in_either_branch_are_all_seen():
    trail, place = UndoLog(), {"items": (A,)}
    branches = [writer(trail, place, "items", (A, B)), writer(trail, place, "items", (A, C))]
    trail.run_branches(branches, {})
    assert set(place["items"]) == {A, B, C}


def test_a_list_emptied_in_one_branch_still_may_hold_its_items():
    trail, place = UndoLog(), {"items": (A,)}
    trail.run_branches([writer(trail, place, "items", ()), lambda: True], {})
    assert place["items"] == (A,)


def test_a_list_open_in_one_branch_is_open():
    trail, place = UndoLog(), {}
    trail.run_branches([writer(trail, place, "open", True), lambda: True], {})  # noqa: FBT003
    assert place["open"] is True


VALUES = st.sampled_from([A, B, C])
WRITES = st.lists(st.tuples(st.sampled_from("xyz"), VALUES), max_size=4)


@given(st.dictionaries(st.sampled_from("xyz"), VALUES), st.lists(WRITES, min_size=1, max_size=3))
def test_each_key_may_hold_what_any_branch_left(start, branches):
    trail, place = UndoLog(), dict(start)

    def run(writes):
        for key, value in writes:
            trail.set(place, key, value)
        return True

    trail.run_branches([lambda writes=writes: run(writes) for writes in branches], {})
    ends = [{**start, **dict(writes)} for writes in branches]
    for key in "xyz":
        assert set(av.options(place.get(key))) == {end[key] for end in ends if key in end}
