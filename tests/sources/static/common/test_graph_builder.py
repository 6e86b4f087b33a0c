"""What is said several times is in a graph once."""

from rtron.sources.code.reachability import UNREACHED
from rtron.sources.static.common.graph_builder import GraphBuilder
from rtron.vocabulary import Evidence, UnresolvedItem


def note(what, why, file, *lines):
    places = tuple(Evidence(file=file, line=line) for line in lines)
    return UnresolvedItem(what=what, why=why, evidence=places)


def built(*notes):
    builder = GraphBuilder()
    builder.add_unresolved(*notes)
    return list(builder.build("app").unresolved)


def test_functions_that_nothing_calls_are_one_note_for_a_file_whichever_programs_have_it():
    notes = [
        note("a() and 1 more", UNREACHED, "x.cpp", 1, 4),
        note("b() and 1 more", UNREACHED, "x.cpp", 4, 9),
        note("c()", UNREACHED, "y.cpp", 2),
    ]
    assert built(*notes) == [
        note("a() and 2 more", UNREACHED, "x.cpp", 1, 4, 9),
        note("c()", UNREACHED, "y.cpp", 2),
    ]


def test_the_same_of_several_places_of_a_file_is_one_note_with_all_places():
    same = [note("f()", "why", "x.cpp", 1), note("f()", "why", "x.cpp", 3)]
    others = [note("f()", "other", "x.cpp", 1), note("f()", "why", "y.cpp", 1)]
    assert built(*same, *others) == [note("f()", "why", "x.cpp", 1, 3), *others]
