"""The lists are data; a user's file adds to them, and its faults are told with the nearest word."""

from importlib.resources import files

import pytest
from notation import graph_of

from rtron.errors import InputError
from rtron.risks import RiskLists, default_lists, discover_risks, load_lists
from rtron.risks.graph_facts import GraphFacts
from rtron.vocabulary import Domain, Sharing, StreamKind


@pytest.fixture
def lists_file(tmp_path):
    path = tmp_path / "my_lists.yaml"

    def write(text: str):
        path.write_text(text, encoding="utf-8")
        return path

    return write


def rules_found(text: str, lists: RiskLists) -> set[str]:
    return {risk.rule for risk in discover_risks(graph_of("app", text), lists).risks}


def test_without_a_file_the_default_lists_are_loaded_once():
    assert load_lists() is default_lists() is load_lists(None)


@pytest.mark.parametrize(
    ("words", "text", "rule"),
    [
        ("event_msg_type: [my/Fire]", "/a a own\n pub /x my/msg/Fire\n", "msr_event"),
        ("event_topic_name: [alarm]", "/a a own\n pub /alarm p/T\n", "msr_event"),
        ("action_msg_type: [my/Grasp]", "/a a own\n pub /x my/Grasp\n", "msr_action"),
        ("action_topic_name: [order]", "/a a own\n pub /order p/T\n", "msr_action"),
        (
            "max_vel_type: [std_msgs/Float32]",
            "/a a own\n pub /max_vel std_msgs/Float32\n",
            "rsr_max_vel",
        ),
        ("max_vel_name: [limit]", "/a a own\n pub /limit std_msgs/Float64\n", "rsr_max_vel"),
        (
            "recog_topic_name: [cars]",
            "/a a own\n sub /x sensor_msgs/Image\n pub /cars p/T\n",
            "rsr_image",
        ),
        ("image_type: [my/Frame]", "/a a own\n sub /x my/Frame\n pub /faces p/T\n", "rsr_image"),
    ],
)
def test_a_word_of_the_users_is_looked_for_too(lists_file, words, text, rule):
    assert rule not in rules_found(text, default_lists())
    assert rule in rules_found(text, load_lists(lists_file(words)))


@pytest.mark.parametrize(
    "words", ["ignored_topics: ['/x*']", "ignored_types: ['p/*']", "ignored_packages: ['c']"]
)
def test_what_the_user_ignores_is_ignored_too(lists_file, words):
    text = "/a a own\n pub /xy p/T\n/b b own\n pub /xy p/T\n/c c own\n sub /xy p/T\n"
    assert "gr_st" in rules_found(text, default_lists())
    assert "gr_st" not in rules_found(text, load_lists(lists_file(words)))


def test_a_table_entry_of_the_users_is_asked_first(lists_file):
    entries = """
domains:
  - domain: Drivers
    types: [geometry_msgs/Twist]
    topics: ["/wheels/*"]
sharing:
  - {sharing: merge, topics: [/wheels/left]}
kinds:
  - {kind: state, types: [geometry_msgs/msg/Twist]}
"""
    lists = load_lists(lists_file(entries))
    found = lists.classify("geometry_msgs/Twist", "/wheels/left")
    assert found.domain is Domain.DRIVERS
    assert found.sharing is Sharing.MERGE
    assert found.kind is StreamKind.STATE
    assert lists.classify("geometry_msgs/Twist", "/cmd_vel").domain is Domain.CONTROL


@pytest.mark.parametrize(
    ("text", "message", "help"),
    [
        ("event_msg_typ: [a/B]", "unknown list 'event_msg_typ'", "event_msg_type"),
        ("EVENT: [a/B]", "unknown list 'EVENT'", "choose from"),
        ("domain: []", "unknown list 'domain'", "domains"),
        ("event_msg_type: a/B", "event_msg_type is no list", "write"),
        ("event_msg_type:", "event_msg_type is no list", "write"),
        ("event_msg_type: [1]", "event_msg_type holds 1", ""),
        ("event_msg_type: ['']", "event_msg_type holds ''", ""),
        (
            "domains: [{domain: Perceptoin, types: [a/B]}]",
            "unknown domain 'Perceptoin'",
            "Perception",
        ),
        ("domains: [{domain: Control, type: [a/B]}]", "unknown key in domains 'type'", "types"),
        ("domains: [{domain: Control}]", "neither types nor topics", ""),
        ("domains: [Control]", "an entry of domains needs `domain:`", ""),
        ("sharing: [{sharing: merges, types: [a/B]}]", "unknown sharing 'merges'", "merge"),
        (
            "kinds: [{kind: [a], types: [a/B]}]",
            "unknown kind",
            "choose from command, action, state",
        ),
        ("kinds: {kind: state}", "kinds is no list", ""),
        ("- a", "holds no lists", "event_msg_type"),
        ("", "holds no lists", "event_msg_type"),
        ("a: [", "not YAML", ""),
        ("a: !!python/object:os.system x", "not YAML", ""),
        ("[" * 10_000, "not YAML", ""),
        ("\x00", "not YAML", ""),
        ("? [a]\n: [b]", "not YAML", ""),
    ],
)
def test_a_fault_is_told_with_the_file_and_the_nearest_word(lists_file, text, message, help):
    path = lists_file(text)
    with pytest.raises(InputError) as caught:
        load_lists(path)
    assert str(caught.value).startswith(f"{path}:")
    assert message in str(caught.value)
    assert help in caught.value.help


def test_a_syntax_error_has_its_line(lists_file):
    with pytest.raises(InputError) as caught:
        load_lists(lists_file("event_msg_type: []\n\nb: ]\n"))
    assert caught.value.line == 3


def test_a_file_that_cannot_be_read_is_an_input_error(tmp_path):
    with pytest.raises(InputError, match="No such file"):
        load_lists(tmp_path / "none.yaml")
    (tmp_path / "latin.yaml").write_bytes(b"\xff")
    with pytest.raises(InputError, match="UTF-8"):
        load_lists(tmp_path / "latin.yaml")
    (tmp_path / "large.yaml").write_bytes(b"#" * (2**20 + 1))
    with pytest.raises(InputError, match="larger"):
        load_lists(tmp_path / "large.yaml")


def test_aliases_do_not_explode(lists_file):
    bomb = "a: &a [x]\n" + "".join(f"l{i}: &l{i} [*a, *a]\n" for i in range(30))
    with pytest.raises(InputError):
        load_lists(lists_file(bomb))


def test_every_list_of_the_file_is_a_field_and_the_other_way_round():
    shipped = (files("rtron.risks") / "data" / "lists.yaml").read_text("utf-8")
    shipped += (files("rtron.risks") / "data" / "domains.yaml").read_text("utf-8")
    named = {line[:-1] for line in shipped.splitlines() if line[:1].isalpha()}
    assert named == set(RiskLists.__dataclass_fields__)
    assert all(getattr(default_lists(), name) for name in named)


@pytest.mark.parametrize(
    ("topic", "type", "is_command"),
    [
        ("/cmd_vel", "geometry_msgs/Twist", True),
        ("/scan", "sensor_msgs/LaserScan", False),
        ("/plan", "nav_msgs/Path", False),
    ],
)
def test_what_commands_motion(topic, type, is_command):
    graph = graph_of("app", f"/a pkg third_party\n    pub {topic} {type}")
    facts = GraphFacts(graph, default_lists())
    assert facts.is_motion_command(topic) is is_command
