import io
import json
import sys
from types import SimpleNamespace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rtron.errors import InputError
from rtron.sources import graph_json
from rtron.sources.graph_json import GraphFile, graph_json_schema, graph_to_json, read_graph
from rtron.vocabulary import (
    GRAPH_SCHEMA,
    Action,
    ActionRole,
    Direction,
    Domain,
    Durability,
    Endpoint,
    Evidence,
    FunctionType,
    InteractionGraph,
    Liveliness,
    Node,
    QoS,
    Reliability,
    Resolution,
    Service,
    Topic,
    Trust,
    UnresolvedItem,
)

words = st.text(st.characters(exclude_categories=["Cs"]), max_size=8)
evidence = st.lists(st.builds(Evidence, file=words, line=st.integers(0, 2**31))).map(tuple)
qos = st.builds(
    QoS,
    reliability=st.sampled_from(Reliability),
    durability=st.sampled_from(Durability),
    depth=st.integers(0, 2**31),
    deadline=st.integers(0, 2**62),
    lifespan=st.integers(0, 2**62),
    liveliness=st.sampled_from(Liveliness),
    lease=st.integers(0, 2**62),
)
NODES = ("/a", "/b\x1b[31m", '/"c"', "")
TOPICS = ("/cmd_vel", "/scan\n", "{prefix}/scan")
nodes = st.tuples(
    *(
        st.builds(
            Node,
            name=st.just(name),
            package=words,
            executable=words,
            origin=words,
            trust=st.sampled_from(Trust),
            function=st.none() | st.sampled_from(FunctionType),
            domain=st.none() | st.sampled_from(Domain),
        )
        for name in NODES
    )
)
topics = st.tuples(
    *(st.builds(Topic, name=st.just(name), types=st.lists(words).map(tuple)) for name in TOPICS)
)
endpoints = st.builds(
    Endpoint,
    node=st.sampled_from(NODES),
    topic=st.sampled_from(TOPICS),
    direction=st.sampled_from(Direction),
    type=words,
    declared_name=words,
    implicit=st.booleans(),
    resolution=st.sampled_from(Resolution),
    qos=st.none() | qos,
    gid=words,
    evidence=evidence,
)
graphs = st.builds(
    InteractionGraph,
    app=words,
    ros=st.sampled_from([1, 2]),
    nodes=nodes,
    topics=topics,
    endpoints=st.lists(endpoints).map(tuple),
    services=st.lists(
        st.builds(
            Service, node=st.sampled_from(NODES), name=words, type=words, implicit=st.booleans()
        )
    ).map(tuple),
    actions=st.lists(
        st.builds(
            Action,
            node=st.sampled_from(NODES),
            name=words,
            type=words,
            role=st.sampled_from(ActionRole),
        )
    ).map(tuple),
    unresolved=st.lists(st.builds(UnresolvedItem, what=words, why=words, evidence=evidence)).map(
        tuple
    ),
)


@pytest.fixture
def written(tmp_path):
    def write(document):
        path = tmp_path / "graph.json"
        data = document if isinstance(document, bytes) else json.dumps(document).encode()
        path.write_bytes(data)
        return path

    return write


def endpoint(**keys):
    return {"node": "/a", "topic": "/t", "direction": "publish"} | keys


def document(**keys):
    return {"schema": GRAPH_SCHEMA} | keys


def fault(path):
    with pytest.raises(InputError) as raised:
        read_graph(path)
    assert raised.value.help
    return str(raised.value)


@given(graphs)
def test_what_is_written_is_read_again(tmp_path_factory, graph):
    path = tmp_path_factory.getbasetemp() / "graph.json"
    path.write_text(json.dumps(graph_to_json(graph)), encoding="utf-8")
    assert read_graph(path) == graph


def test_keys_are_those_of_the_contract():
    graph = InteractionGraph(
        app="app",
        nodes=(Node(name="/a"),),
        topics=(Topic(name="/t", types=("std_msgs/String",)),),
        endpoints=(
            Endpoint(
                node="/a",
                topic="/t",
                direction=Direction.PUBLISH,
                evidence=(Evidence(file="a.py", line=3),),
            ),
        ),
        services=(Service(node="/a", name="/s"),),
        actions=(Action(node="/a", name="/go", role=ActionRole.SERVER),),
        unresolved=(UnresolvedItem(what="x", why="y"),),
    )
    assert graph_to_json(graph) == {
        "schema": "rtron.graph/1",
        "app": "app",
        "ros": 1,
        "nodes": [
            {"name": "/a", "package": "", "executable": "", "origin": "", "trust": "unknown"}
        ],
        "topics": [{"name": "/t", "types": ["std_msgs/String"]}],
        "endpoints": [
            {
                "node": "/a",
                "topic": "/t",
                "declared_name": "",
                "direction": "publish",
                "type": "",
                "implicit": False,
                "resolution": "literal",
                "evidence": [{"file": "a.py", "line": 3}],
            }
        ],
        "services": [{"node": "/a", "name": "/s", "type": ""}],
        "actions": [{"node": "/a", "name": "/go", "type": "", "role": "server"}],
        "unresolved": [{"what": "x", "why": "y", "evidence": []}],
    }


def test_what_only_ros_2_has_is_written_where_it_is_known():
    known = Endpoint(
        node="/a", topic="/t", direction=Direction.PUBLISH, qos=QoS(depth=5, lease=7), gid="01ff"
    )
    services = (Service(node="/a", name="/s", implicit=True),)
    graph = InteractionGraph(app="app", ros=2, endpoints=(known,), services=services)
    json = graph_to_json(graph)
    (written,) = json["endpoints"]
    assert written["gid"] == "01ff"
    assert written["qos"] == {
        "reliability": "reliable",
        "durability": "volatile",
        "depth": 5,
        "deadline": 0,
        "lifespan": 0,
        "liveliness": "automatic",
        "lease": 7,
    }
    assert json["services"] == [{"node": "/a", "name": "/s", "type": "", "implicit": True}]


def test_everything_but_the_schema_is_optional(written):
    assert read_graph(written(document())) == InteractionGraph(app="")


def test_nodes_and_topics_that_only_endpoints_name_are_added(written):
    graph = read_graph(
        written(
            document(
                nodes=[{"name": "/b", "trust": "own"}],
                endpoints=[
                    endpoint(type="x/Y"),
                    endpoint(node="/b", type="x/Z"),
                    endpoint(type="x/Y"),
                ],
                services=[{"node": "/c", "name": "/s"}],
                actions=[{"node": "/d", "name": "/go", "role": "client"}],
            )
        )
    )
    assert [node.name for node in graph.nodes] == ["/b", "/a", "/c", "/d"]
    assert graph.nodes[0].trust is Trust.OWN
    assert graph.topics == (Topic(name="/t", types=("x/Y", "x/Z")),)


def test_a_byte_order_mark_is_no_fault(written):
    assert read_graph(written(b"\xef\xbb\xbf" + json.dumps(document()).encode())).ros == 1


def test_standard_input_is_a_dash(monkeypatch):
    stdin = SimpleNamespace(buffer=io.BytesIO(json.dumps(document(app="x")).encode()))
    monkeypatch.setattr(sys, "stdin", stdin)
    assert read_graph(graph_json.Path("-")).app == "x"


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        ({"app": "x"}, "schema: is missing"),
        ({"schema": "rtron.graph/2"}, "schema: must be 'rtron.graph/1', not 'rtron.graph/2'"),
        ({"schema": "rtron.risks/1", "risks": []}, "schema: must be 'rtron.graph/1'"),
        (document(ros=3), "ros: must be less than or equal to 2, not 3"),
        (document(ros=True), "ros: must be a valid integer, not True"),
        (document(app=None), "app: must be a valid string, not None"),
        (document(nodes={}), "nodes: must be a valid array, not an object"),
        (document(nodes=[[]]), "nodes[0]: must be an object, not a list"),
        (document(nodez=[]), "nodez: is not a key of the schema"),
        (document(endpoints=[endpoint(), {"node": "/a"}]), "endpoints[1].topic: is missing"),
        (document(endpoints=[endpoint(direction="publihs")]), "endpoints[0].direction: must be"),
        (document(endpoints=[endpoint(typ="x")]), "endpoints[0].typ: is not a key"),
        (
            document(endpoints=[endpoint(evidence=[{"file": "a", "line": "3"}])]),
            "endpoints[0].evidence[0].line: must be a valid integer, not '3'",
        ),
        (document(endpoints=[endpoint(qos={"reliable": 1})]), "endpoints[0].qos.reliable: is not"),
        ([], "the document: must be an object, not a list"),
        (b"", "not JSON"),
        (b"\x7fELF\x02\x01\x01\0\0", "a binary file"),
        (b'{"schema": "rtron.graph/1", "app": "\xff"}', "not JSON"),
        (b"[" * 100_000, "not JSON: recursion limit"),
        (b'{\n"schema":\n', ":3: not JSON"),
    ],
)
def test_a_wrong_document_is_refused_and_the_place_named(written, wrong, said):
    assert said in fault(written(wrong))


@pytest.mark.parametrize(
    ("wrong", "help"),
    [
        (document(endpoints=[endpoint(direction="publis")]), "did you mean `publish`?"),
        (document(endpoints=[endpoint(topik="x")]), "did you mean `topic`?"),
        (document(endpoints=[{"node": "/a", "topik": "/t"}]), "did you mean `topic`?"),
        (document(nods=[]), "did you mean `nodes`?"),
        (document(x=[]), "it can be schema, app, ros, nodes"),
        (document(endpoints=[endpoint(qos={"depht": 1})]), "did you mean `depth`?"),
        (document(unresolved=[{"what": "", "why": "", "evidence": [{"fil": ""}]}]), "`file`"),
    ],
)
def test_the_nearest_word_is_offered(written, wrong, help):
    with pytest.raises(InputError) as raised:
        read_graph(written(wrong))
    assert help in raised.value.help


def test_a_long_value_is_not_repeated_whole(written):
    assert len(fault(written(document(ros="9" * 10_000)))) < 300


def test_a_file_past_the_limit_is_refused(written, monkeypatch):
    path = written(document())
    size = path.stat().st_size
    monkeypatch.setattr(graph_json, "MAX_BYTES", size)
    assert read_graph(path).ros == 1
    monkeypatch.setattr(graph_json, "MAX_BYTES", size - 1)
    assert "larger than" in fault(path)


def test_a_file_that_cannot_be_opened_is_an_input_error(tmp_path):
    assert "No such file" in fault(tmp_path / "none.json")
    assert "directory" in fault(tmp_path)


def test_a_graph_file_is_a_source(written):
    assert GraphFile(written(document(app="x"))).read() == InteractionGraph(app="x")


def test_the_json_schema_forbids_unknown_keys():
    schema = graph_json_schema()
    assert schema["additionalProperties"] is False
    assert schema["$defs"]["Endpoint"]["required"] == ["node", "topic", "direction"]
