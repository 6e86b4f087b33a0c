"""What a model may say: names, conditions, loops, parts, files; what is not known stays visible."""

import pytest
from model_cases import names, parameters, site, told

from rtron.errors import InputError
from rtron.sources.declaration import NodeSite
from rtron.sources.models import load_models, node_interface
from rtron.vocabulary import Resolution, UnknownValue

HEAD = "node: my/node\nsource: github.com/me/my@1.0 src/node.cpp\n"


@pytest.fixture
def library(tmp_path):
    def load(*models: str):
        folder = tmp_path / "models"
        folder.mkdir(exist_ok=True)
        for number, text in enumerate(models):
            (folder / f"{number}.yaml").write_text(text, encoding="utf-8")
        load_models.cache_clear()
        return load_models(folder)

    yield load
    load_models.cache_clear()


@pytest.fixture
def evaluated(library):
    def evaluate(declares: str, *parts: str, let: str = "", **at):
        models = library(HEAD + let + "declares:\n" + declares, *parts)
        return node_interface(models.node("my", "node"), site(**at), models=models)

    return evaluate


@pytest.mark.parametrize(
    ("written", "name"),
    [
        ("scan", "/robot/scan"),
        ("~scan", "/robot/driver/scan"),
        ("/scan", "/scan"),
        ("\"~{param('~topic')}\"", "/absolute"),
        ("\"{param('~missing', 'odom')}\"", "/robot/odom"),
        ("\"{param('beside', 'odom')}/x\"", "/robot/near/x"),
        ("\"{search('high', 'none')}\"", "/robot/up"),
        ("\"{search('low', 'none')}\"", "/robot/none"),
        ('"{basename(node)}_x"', "/robot/driver_x"),
        ('"a//b/"', "/robot/a/b"),
    ],
)
def test_a_name_resolves_as_in_the_node(evaluated, written, name):
    values = {"/robot/driver/topic": "/absolute", "/robot/beside": "near", "/high": "up"}
    found = evaluated(f"- {{publish: {written}, type: p/T, line: 7}}\n", values=values)
    (declaration,) = found.declarations
    assert declaration.name == name
    assert declaration.resolution is Resolution.MODEL
    (evidence,) = declaration.evidence
    assert (evidence.file, evidence.line) == ("github.com/me/my@1.0 src/node.cpp", 7)


def test_an_unknown_parameter_leaves_a_hole(evaluated):
    text = "- {publish: \"{param('~prefix', 'x')}/odom\", type: p/T}\n"
    found = evaluated(text, values={"/robot/driver/prefix": UnknownValue("at run time")})
    (declaration,) = found.declarations
    assert declaration.name == "/robot/{~prefix}/odom"
    assert declaration.resolution is Resolution.SYMBOLIC


@pytest.mark.parametrize(
    ("value", "declared", "resolution"),
    [
        (None, set(), None),
        (False, set(), None),
        ("false", set(), None),
        (True, {"/robot/map"}, Resolution.MODEL),
        (1, {"/robot/map"}, Resolution.MODEL),
        (UnknownValue("why"), {"/robot/map"}, Resolution.SYMBOLIC),
    ],
)
def test_a_condition_on_a_parameter(evaluated, value, declared, resolution):
    text = "- {subscribe: map, type: p/T, if: \"truth(param('~use_map', false))\"}\n"
    values = {} if value is None else {"/robot/driver/use_map": value}
    found = evaluated(text, values=values)
    assert names(found, "subscribe") == declared
    assert {d.resolution for d in found.declarations} == ({resolution} if resolution else set())
    assert bool(found.unresolved) is (resolution is Resolution.SYMBOLIC)


def test_a_comparison_with_an_unknown_value_keeps_the_entry(evaluated):
    text = "- {subscribe: a, type: p/T, if: \"int(param('~n', 0)) > 3\"}\n"
    found = evaluated(text, values={"/robot/driver/n": UnknownValue("why")})
    assert names(found, "subscribe") == {"/robot/a"}


def test_loops_over_a_list_of_structs_and_over_words(evaluated):
    text = (
        "- subscribe: \"{get(entry, 'topic', 'none')}\"\n  type: p/T\n"
        "  for: entry in items(param('~topics', []))\n"
        "- {publish: \"{word}\", type: p/T, for: \"word in split(param('~words', ''))\"}\n"
    )
    values = {
        "/robot/driver/topics": [{"topic": "a"}, {"topic": "/b"}, {}],
        "/robot/driver/words": " c  d ",
    }
    found = evaluated(text, values=values)
    assert names(found, "subscribe") == {"/robot/a", "/b", "/robot/none"}
    assert names(found, "publish") == {"/robot/c", "/robot/d"}


def test_a_loop_over_an_unknown_list_declares_one_hole(evaluated):
    text = (
        "- {subscribe: \"{get(entry, 'topic')}\", type: p/T,"
        " for: \"entry in items(param('~topics', []))\"}\n"
    )
    found = evaluated(text, values={"/robot/driver/topics": UnknownValue("why")})
    (declaration,) = found.declarations
    assert declaration.name == "/robot/{~topics.topic}"
    assert declaration.resolution is Resolution.SYMBOLIC


def test_an_unknown_member_of_a_known_list_leaves_its_own_hole(evaluated):
    text = (
        "- {subscribe: \"{get(entry, 'topic')}\", type: p/T,"
        " for: \"entry in items(param('~topics', []))\"}\n"
    )
    topics = [{"topic": "a"}, {"topic": UnknownValue("why")}]
    found = evaluated(text, values={"/robot/driver/topics": topics})
    assert names(found, "subscribe") == {"/robot/a", "/robot/{~topics/1/topic}"}


@pytest.mark.parametrize(
    "topic", [None, "", "two words", "a-b", "~~x", ["list"], {"a": "dict"}, "x" * 5000, "tòpic"]
)
def test_what_is_no_name_is_unresolved(evaluated, topic):
    text = "- {subscribe: \"{param('~topic')}\", type: p/T}\n- {publish: ok, type: p/T}\n"
    found = evaluated(text, values={} if topic is None else {"/robot/driver/topic": topic})
    assert told(found) == {("publish", "/robot/ok", "p/T")}
    assert len(found.unresolved) == 1


def test_a_very_deep_parameter_ends_in_a_hole(evaluated):
    deep = "x"
    for _ in range(5000):
        deep = [deep]
    text = "- {subscribe: \"{get(param('~a'), 0)}\", type: p/T}\n- {publish: ok, type: p/T}\n"
    found = evaluated(text, values={"/robot/driver/a": deep})
    assert "/robot/ok" in names(found, "publish")


def test_numbered_parameters_end_at_the_first_gap(evaluated):
    text = "- {subscribe: \"{topic}\", type: p/T, for: topic in counted('~odom')}\n"
    values = {f"/robot/driver/odom{n}": f"o{n}" for n in (0, 1, 3)}
    assert names(evaluated(text, values=values), "subscribe") == {"/robot/o0", "/robot/o1"}


PART = """part: inner
source: github.com/me/part@2.0 part.cpp
implicit: true
needs: [topic]
declares:
- {publish: "{topic}", type: p/T, line: 3}
- {service: ~set, type: p/S, line: 4}
"""


def test_a_part_has_its_own_handles_and_is_implicit(evaluated):
    text = "- {uses: inner, namespace: /other, private: ~sub, with: {topic: \"'a'\"}, line: 9}\n"
    found = evaluated(text, PART)
    assert told(found) == {
        ("publish", "/other/a", "p/T"),
        ("service", "/robot/driver/sub/set", "p/S"),
    }
    assert all(d.implicit for d in found.declarations)
    user, part = "github.com/me/my@1.0 src/node.cpp", "github.com/me/part@2.0 part.cpp"
    assert [[(e.file, e.line) for e in d.evidence] for d in found.declarations] == [
        [(user, 9), (part, 3)],
        [(user, 9), (part, 4)],
    ]


def test_a_remap_of_a_handles_namespace_moves_what_is_below(evaluated):
    text = "- {publish: a, type: p/T, namespace: rgb}\n"
    found = evaluated(text, remaps=[("/robot/rgb", "/camera")])
    assert names(found, "publish") == {"/camera/a"}


def test_the_name_itself_is_not_remapped_but_what_hangs_below_it_is(evaluated):
    text = "- {publish: image, type: p/T}\n- {publish: \"{remapped('image')}/x\", type: p/T}\n"
    found = evaluated(text, remaps=[("/robot/image", "/out")])
    assert names(found, "publish") == {"/robot/image", "/out/x"}


def test_a_plugin_without_a_model_and_models_without_end_are_unresolved(evaluated):
    text = "- {uses: \"plugin:{param('~planner', 'a/B')}\"}\n- {uses: \"node:my/node\"}\n"
    found = evaluated(text)
    assert {(u.what, u.why) for u in found.unresolved} >= {
        ("plugin:a/B", "no model of it: what it gives /robot/driver is missing"),
        ("node:my/node", "models use each other too deep: what it gives /robot/driver is missing"),
    }


@pytest.mark.parametrize(
    ("expression", "why"),
    [
        ("open('/etc/passwd')", "not of the kind"),
        ("().__class__", "double underscores"),
        ("1 / 0", "division"),
        ("missing", "missing"),
        ("'x' * 10000", "too large"),
    ],
)
def test_what_has_no_value_is_unresolved_and_the_rest_stays(evaluated, expression, why):
    text = f'- {{publish: "{{{expression}}}", type: p/T}}\n- {{publish: b, type: p/T}}\n'
    found = evaluated(text)
    assert names(found, "publish") == {"/robot/b"}
    assert why in found.unresolved[0].why


def test_arguments(evaluated):
    text = (
        '- {publish: "{argument(0)}", type: p/T}\n'
        "- {publish: \"{argument(1, 'none', '-r')}\", type: p/T}\n"
        "- {publish: \"{option('-r --rate', 'no')}\", type: p/T}\n"
        "- {publish: \"late\", type: p/T, if: has_option('-l')}\n"
    )
    found = evaluated(text, args="in x:=y -r 10 out -dl")
    assert names(found, "publish") == {"/robot/in", "/robot/out", "/robot/10", "/robot/late"}


def test_the_distribution_comes_from_the_environment(evaluated):
    text = "- {publish: new, type: p/T, if: since('noetic')}\n"
    assert names(evaluated(text), "publish") == {"/robot/new"}
    assert not evaluated(text, environ=[("ROS_DISTRO", "melodic")]).declarations


def test_an_action_and_an_unknown_type(evaluated):
    text = "- {action_server: move, type: p/MoveAction}\n- {publish: a, type: any}\n"
    assert told(evaluated(text)) == {
        ("action_server", "/robot/move", "p/MoveAction"),
        ("publish", "/robot/a", ""),
    }


def test_a_name_declared_twice_has_the_evidence_of_both(evaluated):
    text = '- {publish: a, type: p/T, line: 1}\n- {publish: a, type: p/T, at: "b.cpp:2"}\n'
    (declaration,) = evaluated(text).declarations
    assert [(e.file, e.line) for e in declaration.evidence] == [
        ("github.com/me/my@1.0 src/node.cpp", 1),
        ("github.com/me/my@1.0 b.cpp", 2),
    ]


def test_long_lists_are_bounded(evaluated):
    text = '- {publish: "a{n}", type: p/T, for: "n in range(0, 4000)"}\n'
    assert len(evaluated(text).declarations) == 1000


@pytest.mark.parametrize(
    ("text", "line", "why"),
    [
        ("node: a/b\nsource: nowhere\n", 1, "github.com/OWNER/NAME@TAG PATH"),
        ("source: github.com/a/b@1 c\n", 1, "a model needs one of"),
        (HEAD + "declares:\n- {publish: a}\n", 4, "needs a type"),
        (HEAD + "declares:\n- {publish: a, subscribe: b, type: p/T}\n", 4, "exactly one"),
        (HEAD + "declares:\n- publish: a\n  typ: p/T\n", 5, "Extra inputs"),
        (HEAD + "declares:\n- {publish: a, type: p/T, for: x}\n", 4, "pattern"),
        (HEAD + "declares: [\n", 4, "not YAML"),
        ("a: &x 1\nb: *x\n", 1, "aliases"),
        ("!!python/object:os.system {}\n", 1, "not YAML"),
        ("", 0, "empty"),
    ],
)
def test_a_wrong_model_names_its_file_and_line(library, text, line, why):
    with pytest.raises(InputError) as raised:
        library(text)
    assert why in str(raised.value)
    assert raised.value.line == line
    assert raised.value.path.endswith("0.yaml")


def test_a_misspelt_key_suggests_the_right_one(library):
    with pytest.raises(InputError) as raised:
        library(HEAD + "declares:\n- publish: a\n  typ: p/T\n")
    assert raised.value.help == "did you mean type?"


def test_two_models_of_one_node_are_refused(library):
    with pytest.raises(InputError, match="another model"):
        library(HEAD, HEAD)


def test_models_are_loaded_once():
    assert load_models() is load_models()


def test_a_node_of_the_root_namespace(library):
    models = library(HEAD + "declares:\n- {publish: a, type: p/T}\n- {publish: ~a, type: p/T}\n")
    node = NodeSite(name="/n", parameters=parameters({}))
    assert names(node_interface(models.node("my", "node"), node, models=models), "publish") == {
        "/a",
        "/n/a",
    }
