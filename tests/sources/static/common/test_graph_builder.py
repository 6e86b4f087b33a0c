"""What is said several times is in a graph once."""

from rtron.sources.static.common.graph_builder import GraphBuilder
from rtron.vocabulary import Evidence, UnresolvedCause, UnresolvedItem


def note(what, why, file, *lines, cause=None):
    places = tuple(Evidence(file=file, line=line) for line in lines)
    return UnresolvedItem(what=what, why=why, cause=cause, evidence=places)


def unreached(what, file, *lines):
    return note(what, "not called", file, *lines, cause=UnresolvedCause.UNREACHED)


def built(*notes):
    builder = GraphBuilder()
    builder.add_unresolved(*notes)
    return list(builder.build("app").unresolved)


def test_functions_that_nothing_calls_are_one_note_for_a_file_whichever_programs_have_it():
    notes = [
        unreached("a() and 1 more", "x.cpp", 1, 4),
        unreached("b() and 1 more", "x.cpp", 4, 9),
        unreached("c()", "y.cpp", 2),
    ]
    assert built(*notes) == [
        unreached("a() and 2 more", "x.cpp", 1, 4, 9),
        unreached("c()", "y.cpp", 2),
    ]


def test_the_same_of_several_places_of_a_file_is_one_note_with_all_places():
    same = [note("f()", "why", "x.cpp", 1), note("f()", "why", "x.cpp", 3)]
    others = [note("f()", "other", "x.cpp", 1), note("f()", "why", "y.cpp", 1)]
    assert built(*same, *others) == [note("f()", "why", "x.cpp", 1, 3), *others]
