"""The functions of nodes as text for people."""

import pytest

from rtron.reports.app.node_endpoints import MOST_NAMES, node_functions
from rtron.reports.text_layout import Report
from rtron.vocabulary import Domain, FunctionType, Node


@pytest.fixture
def text(printed):
    return lambda nodes: printed(Report(lambda page: node_functions(nodes, page)), width=200)


def mapping(number):
    mapping = {"function": FunctionType.MAPPING, "domain": Domain.PERCEPTION}
    return [Node(name=f"/m{i}", **mapping) for i in range(number)]


def test_nothing_where_nothing_is_known(text):
    assert text([]) == text([Node(name="/a")]) == ""


def test_functions_in_the_papers_order_and_the_unknown_last(text):
    drives = Node(name="/base", function=FunctionType.MOBILE, domain=Domain.DRIVERS)
    assert text([Node(name="/x"), drives, *mapping(1)]).split("\n")[1:-1] == [
        "Functions of the nodes",
        "  Perception, Mapping: /m0",
        "  Drivers, Mobile: /base",
        "  not known: /x",
    ]


@pytest.mark.parametrize(
    ("more", "end"), [(0, "/m7"), (1, "/m7, and 1 other"), (2, "/m7, and 2 others")]
)
def test_many_are_counted(text, more, end):
    assert text(mapping(MOST_NAMES + more)).rstrip().endswith(end)
