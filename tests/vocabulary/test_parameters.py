"""The parameter server: leaves, namespaces, the search upwards, and patterns of node names."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rtron.vocabulary import Evidence, LaunchFile, LaunchInclude, LaunchNode, LaunchTree
from rtron.vocabulary.parameters import Parameter, ParameterTree, pattern_matches

FIRST, SECOND = (Evidence(file="a.launch", line=line) for line in (1, 2))
keys = st.sampled_from("abc")
values = st.recursive(
    st.integers(0, 3), lambda inner: st.dictionaries(keys, inner, min_size=1), max_leaves=5
)
names = st.lists(keys, min_size=1, max_size=3).map(lambda parts: "/" + "/".join(parts))


def made(*settings):
    parameters = ParameterTree()
    for name, value in settings:
        parameters.set(name, Parameter(value=value, evidence=FIRST))
    return parameters


def value(parameters, name):
    found = parameters.get(name)
    return None if found is None else found.value


class Tree:
    """The naive model: one tree of dicts, in which nothing empty stands."""

    def __init__(self):
        self.root = {}

    def set(self, name, value):
        *folders, last = name[1:].split("/")
        place = self.root
        for folder in folders:
            if not isinstance(place.get(folder), dict):
                place[folder] = {}
            place = place[folder]
        place[last] = value

    def get(self, name):
        place = self.root
        for part in name[1:].split("/"):
            if not isinstance(place, dict) or part not in place:
                return None
            place = place[part]
        return place


def clashes(settings):
    """Tell whether a name stands below one that has a value: ROS refuses that, we keep both."""
    leaves = [leaf for name, value in settings for leaf in flat(name, value)]
    return any(one != other and other.startswith(one + "/") for one in leaves for other in leaves)


def flat(name, value):
    if not isinstance(value, dict):
        return [name]
    return [leaf for key, inner in value.items() for leaf in flat(f"{name}/{key}", inner)]


@given(st.lists(st.tuples(names, values), max_size=5), names)
def test_it_is_a_tree(settings, name):
    if clashes(settings):
        return
    parameters, tree = made(*settings), Tree()
    for each, given_value in settings:
        tree.set(each, given_value)
    assert value(parameters, name) == tree.get(name)


def test_what_is_set_again_takes_the_place_of_all_below():
    parameters = made(("/robot", {"speed": 1, "arm": {"joints": 6}}), ("/robot/arm", 2))
    assert value(parameters, "/robot") == {"speed": 1, "arm": 2}
    assert value(parameters, "/robot/arm/joints") is None
    parameters.set("/robot", Parameter(value=7, evidence=SECOND))
    assert parameters.get("/robot") == Parameter(value=7, evidence=SECOND)
    assert list(parameters.leaves) == ["/robot"]


def test_a_namespace_is_where_its_first_leaf_is_set():
    parameters = made(("/robot/speed", 1))
    parameters.set("/robot/name", Parameter(value="tb", evidence=SECOND))
    assert parameters.get("/robot").evidence == FIRST
    assert value(parameters, "/") == {"robot": {"speed": 1, "name": "tb"}}


def test_a_name_that_only_begins_alike_is_another():
    parameters = made(("/robot/speed", 1), ("/robot2/speed", 2))
    assert value(parameters, "/robot") == {"speed": 1}
    parameters.set("/robot", Parameter(value=3, evidence=FIRST))
    assert value(parameters, "/robot2/speed") == 2


def test_keys_with_slashes_do_not_leave_their_namespace():
    assert list(made(("/robot/", {"/speed/": 1})).leaves) == ["/robot/speed"]


@pytest.mark.parametrize(
    ("name", "namespace", "expected"),
    [
        ("speed", "/robot/arm", "/robot/speed"),
        ("joints", "/robot/arm", "/robot/arm/joints"),
        ("map", "/robot/arm", "/map"),
        ("arm/other", "/robot/arm", "/robot/arm/other"),
        ("nothing", "/robot/arm", None),
        ("speed", "/", None),
    ],
)
def test_the_search_goes_upwards_for_the_first_part_of_the_name(name, namespace, expected):
    parameters = made(("/robot/speed", 1), ("/robot/arm/joints", 6), ("/map", "office"))
    assert parameters.search(name, namespace) == expected


def test_a_launch_is_walked_in_document_order():
    def node(name):
        return LaunchNode(name=name, package="p", type="e", element_index=1)

    inner = LaunchFile(path="/inner.launch", nodes=(node("/robot/b"),))
    outer = LaunchFile(
        path="/outer.launch",
        nodes=(node("/a"),),
        includes=(LaunchInclude(element_index=2, evaluated_name="inner.launch", file=inner),),
    )
    assert list(outer.walk()) == [outer, inner]
    nodes = LaunchTree(root=outer).nodes()
    assert [(each.name, each.namespace) for each in nodes] == [("/a", "/"), ("/robot/b", "/robot")]


@pytest.mark.parametrize(
    ("pattern", "node", "fits"),
    [
        ("/**", "/a/b", True),
        ("/ns/n", "/ns/n", True),
        ("ns/n", "/ns/n", True),
        ("n", "/ns/n", False),
        ("/**/n", "/ns/a/n", True),
        ("/**/n", "/n", True),
        ("/*/n", "/ns/n", True),
        ("/*/n", "/ns/a/n", False),
        ("/ns/*", "/ns/n", True),
        ("/a.b", "/axb", False),
    ],
)
def test_patterns_of_node_names(pattern, node, fits):
    assert pattern_matches(pattern, node) is fits
