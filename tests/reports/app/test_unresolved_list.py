"""What could not be read, as text: grouped by cause, with what to do."""

import pytest

from rtron.reports.app.unresolved_list import MOST_CAUSES, nodes_read, unresolved_list
from rtron.reports.text_layout import Report
from rtron.vocabulary import Evidence, InteractionGraph, Node, UnresolvedCause, UnresolvedItem

NO_SOURCE = "no source of it is here, and no model"
CALL = "its name comes from a service call"

GROUPED = """\

Not resolved (7)
  Source that is not here (4)
    -> give the folder of its source, or write a model: `rtron model draft`
    node /a (p/a); node /b (p/b); node /c (p/c) and 1 more: no source of it is
    here, and no model (a.launch:1)
  Not followed in the source (3)
    -> look at these places yourself
    a publisher of /odd: its name comes from a service call (odd.cpp:12)
    a file: why not (c.yaml)
"""


@pytest.fixture
def text_of(printed):
    return lambda items, **keys: printed(Report(lambda page: unresolved_list(items, page)), **keys)


def items(*names, why, **keys):
    return tuple(UnresolvedItem(what=name, why=why, **keys) for name in names)


def test_items_are_grouped_by_their_cause(text_of):
    call = items("a publisher of /odd", why=CALL, evidence=(Evidence(file="odd.cpp", line=12),))
    nodes = [f"node /{name} (p/{name})" for name in "abcd"]
    place = (Evidence(file="a.launch", line=1),)
    missing = items(*nodes, why=NO_SOURCE, cause=UnresolvedCause.MISSING_SOURCE, evidence=place)
    one = items("a file", why="why not", evidence=(Evidence(file="c.yaml"),))
    assert text_of(call + one + call + missing) == GROUPED


def test_what_somebody_can_give_comes_first_each_kind_with_its_remedy(text_of):
    causes = [*reversed(UnresolvedCause), None]
    notes = [UnresolvedItem(what=f"{cause}", why="so", cause=cause) for cause in causes]
    notes.append(UnresolvedItem(what="node /m (q/m)", why="none of this name", missing="q/m"))
    rows = text_of(notes, width=200).splitlines()
    titles = [row for row in rows if row.endswith(("(1)", "(2)"))]
    assert titles == [
        "  The app names what is not there (1)",
        "  Source that is not here (1)",
        "  Values that are not given (2)",
        "  Code that is not here and may add endpoints (1)",
        "  Errors in the source (1)",
        "  Programs that are read in part only (2)",
        "  Known only while the app runs (1)",
        "  Functions that nothing which is seen calls (1)",
        "  Not followed in the source (1)",
        "  In robot descriptions, because files that they include are not here (1)",
    ]
    assert [rows[rows.index(title) + 1][:7] for title in titles] == ["    -> "] * len(titles)
    assert rows[-1] == "    -> nothing to do here: give these files"


def test_causes_are_in_order_of_frequency(text_of):
    text = text_of(items("x", why="rare") + items("x", "y", why="frequent"))
    assert text.splitlines()[4:] == ["    x; y: frequent", "    x: rare"]


@pytest.mark.parametrize("more", [0, 1, 3])
def test_more_causes_of_a_kind_are_counted(text_of, more):
    causes = [f"why {i}" for i in range(MOST_CAUSES + more)]
    text = text_of([each for why in causes for each in items("x", why=why)])
    rows = text.splitlines()
    assert rows[1] == f"Not resolved ({MOST_CAUSES + more})"
    assert [row for row in rows if row.startswith("    x: ")] == [
        f"    x: {why}" for why in causes[:MOST_CAUSES]
    ]
    end = f"    and {more} more, which --format graph lists"
    assert rows[4 + MOST_CAUSES :] == ([end] if more else [])


def test_nothing_unresolved_is_nothing_shown(text_of):
    assert text_of(()) == ""


def test_hostile_names_do_nothing(text_of):
    name = "/\x1b[2J[bold red]x[/]\n\u202e:smile:"
    place = (Evidence(file=name, line=1),)
    text = text_of(
        items(name, why=name, evidence=place) + items(name, "x", why=name * 2), width=200
    )
    assert "\x1b" not in text
    assert "\u202e" not in text
    assert text.count("/\\x1b[2J[bold red]x[/]\\n\\u202e:smile:") == 6


def app(read, unread):
    nodes = [Node(name=f"/r{i}") for i in range(read)]
    nodes += [Node(name=f"/u{i}", unread=True) for i in range(unread)]
    return InteractionGraph(app="app", nodes=tuple(nodes))


NOTHING_READ = (
    "nothing can be found in them: correct what is listed as not resolved, or give its source, "
    "and scan again"
)


@pytest.mark.parametrize(
    ("read", "unread", "words"),
    [
        (0, 0, ""),
        (3, 0, ""),
        (2, 1, "2 of 3 nodes read; not read: /u0"),
        (0, 3, f"0 of 3 nodes read; not read: /u0, /u1, /u2; {NOTHING_READ}"),
        (1, 5, "1 of 6 nodes read; not read: /u0, /u1, /u2 and 2 more"),
    ],
)
def test_it_tells_how_many_nodes_were_read(read, unread, words):
    assert nodes_read(app(read, unread)) == words
