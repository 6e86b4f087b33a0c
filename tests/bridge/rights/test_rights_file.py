"""`bridge.yaml`: what is not of its form is refused, with its line; by default, all is denied."""

import json
import re
import textwrap
from pathlib import Path

import jsonschema
import pytest
import yaml
from bridge_parts import PLAN, RIGHTS, TOKEN, plan, rights

from rtron.bridge.common.plan_topics import PlanTopics, check_rights
from rtron.bridge.rights.document import (
    ParameterRights,
    matches_name,
    rights_json_schema,
    same_type,
)
from rtron.bridge.rights.rights_file import parse_rights, read_rights
from rtron.bridge.rights.tokens import SignIn, new_token, rights_entry, token_hash
from rtron.errors import InputError, WireError
from rtron.planning.plan_file.loader import parse_plan

HASH = "sha256:" + "a" * 64
SMALL = f"""schema: rtron.bridge/1
clients:
  - name: web
    tokens: ["{HASH}"]
"""


def problem(text):
    with pytest.raises(InputError) as raised:
        parse_rights(text)
    return str(raised.value)


def test_a_client_that_only_signs_in_may_do_nothing():
    (client,) = parse_rights(SMALL).clients
    assert client.node == "/bridge/web"
    given = (client.publish, client.subscribe, client.call, client.actions)
    assert given == ((), (), (), ())
    assert client.parameters == ParameterRights()


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "bridge.yaml: the file is empty"),
        ("- 1", "bridge.yaml:1: the file"),
        ("schema: rtron.bridge/2\nclients: []", "bridge.yaml:1: schema: it should be"),
        ("schema: rtron.bridge/1", "bridge.yaml:1: clients: is missing"),
        (SMALL + "max_clients: '3'", "bridge.yaml:5: max_clients: it should be a valid integer"),
        (SMALL + "max_clients: true", "bridge.yaml:5: max_clients"),
        (SMALL + "maxclients: 3", "bridge.yaml:5: maxclients: is not a key"),
        (SMALL + "    publsh: []", "bridge.yaml:5: clients[0].publsh: is not a key"),
        (SMALL + "    name: b", "bridge.yaml:5: name stands twice"),
        (
            SMALL + "    publish:\n      - {topic: cmd_vel, type: a/B}",
            "clients[0].publish[0].topic",
        ),
        (SMALL + "    publish:\n      - {topic: /a/*, type: a/B}", "bridge.yaml:6: "),
        (SMALL + "    publish:\n      - {topic: /a, type: a/B, rate: .inf}", "rate"),
        (SMALL + "    publish:\n      - {topic: /a, type: a/B, rate: .nan}", "rate"),
        (SMALL + "    publish:\n      - {topic: /a, type: a/B, rate: 0}", "greater than 0"),
        (SMALL + "    publish:\n      - {topic: /a}", "clients[0].publish[0].type: is missing"),
        (SMALL + "    publish:\n      - {topic: /rtron/cmd_vel/x, type: a/B}", "the guard's own"),
        (SMALL + "    subscribe: [{topic: /a, type: a/B}, {topic: /a, type: a/B}]", "/a twice"),
        (SMALL + f"  - name: web\n    tokens: ['{HASH[:-1]}b']", "there are two clients web"),
        (SMALL + f"  - name: tab\n    tokens: ['{HASH}']", "two tokens are one"),
        (SMALL.replace(HASH, "rtb_secret"), "clients[0].tokens[0]"),
        (SMALL.replace(f'["{HASH}"]', "[]"), "clients[0].tokens"),
        (SMALL.replace("web", "Web"), "clients[0].name"),
        (SMALL.replace("web", "a/b"), "clients[0].name"),
        ("schema: &a rtron.bridge/1\nclients: *a", "anchors and aliases"),
        ("schema: !!python/object x", "tags"),
        ("schema: [", "not YAML"),
        ("{2020-01-01: x}", "not YAML"),
        ("? [a]\n: b", "not YAML"),
    ],
)
def test_what_is_wrong_is_told(text, message):
    assert message in problem(text)


@pytest.mark.parametrize(
    ("group", "topic", "is_open"),
    [
        ("subscribe", "/rtron/gr_base/cmd_vel/active", True),
        ("subscribe", "/rtron/leases/base/status", True),
        ("publish", "/rtron/leases/base/request", True),
        ("publish", "/rtron/gr_base/cmd_vel/active", False),
        ("subscribe", "/rtron/cmd_vel/web", False),
        ("publish", "/rtron", False),
        ("publish", "/rtron/leases/base/status", False),
        ("publish", "/rtron/leases/base/answer", False),
    ],
)
def test_what_the_guard_says_to_all_may_be_read_and_leases_asked_for(group, topic, is_open):
    text = SMALL + f"    {group}: [{{topic: {topic}, type: std_msgs/String}}]"
    if is_open:
        assert getattr(parse_rights(text).clients[0], group)[0].topic == topic
    else:
        assert f"{topic} is the guard's own" in problem(text)


def test_all_that_is_wrong_is_told_at_once():
    text = problem(SMALL + "    publsh: []\n    limits: {frames: 0}\n")
    assert "bridge.yaml:5: " in text
    assert "bridge.yaml:6: " in text


@pytest.mark.parametrize("name", ["/a", "/a/b_1", "/a/*", "/*", "/a:b", "/a:b.c", "/a/b:*"])
def test_names_of_parameters(name):
    granted = parse_rights(SMALL + f'    parameters: {{read: ["{name}"]}}')
    assert granted.clients[0].parameters.read == (name,)


@pytest.mark.parametrize("name", ["a", "*", "/a*", "/a:", "/a:b*", "/a:b:c", "/a/", "/a/*/b", ""])
def test_what_is_no_name_of_a_parameter(name):
    assert "clients[0].parameters.write[0]" in problem(
        SMALL + f'    parameters: {{write: ["{name}"]}}'
    )


def test_a_file_that_is_too_large_is_not_read(tmp_path):
    large = tmp_path / "bridge.yaml"
    large.write_bytes(b" " * ((1 << 20) + 1))
    with pytest.raises(InputError, match="larger than 1 MiB"):
        read_rights(large)


def test_a_reason_names_no_token():
    assert "rtb_secret" not in problem(SMALL.replace(HASH, "rtb_secret"))


def test_the_schema_is_the_file_s(tmp_path):
    schema = rights_json_schema()
    jsonschema.Draft202012Validator.check_schema(schema)
    stored = Path(__file__).parents[3] / "schemas" / "rtron.bridge.json"
    assert json.loads(stored.read_text()) == schema
    document = yaml.safe_load(RIGHTS.format(token=HASH, other=token_hash("b")))
    jsonschema.validate(document, schema)
    with pytest.raises(jsonschema.ValidationError):
        jsonschema.validate({**document, "more": 1}, schema)


def test_a_token_signs_one_client_in_and_is_not_in_the_file():
    signing = SignIn(rights().clients)
    assert signing.find_client(TOKEN).name == "web"
    for token in ("", "rtb_we", TOKEN + " ", token_hash(TOKEN), "ä", "\ud800", "x" * 1_000_000):
        assert signing.find_client(token) is None
    assert TOKEN not in RIGHTS.format(token=token_hash(TOKEN), other="")


def test_tokens_are_long_and_differ():
    one, other = new_token(), new_token()
    assert one != other
    assert len(one) >= 43


def test_the_entry_of_a_new_token_is_one_that_the_file_takes():
    token = new_token()
    entry = rights_entry("tablet", token).partition("\n\n")[2]
    (client,) = parse_rights(f"schema: rtron.bridge/1\nclients:\n{entry}").clients
    assert SignIn([client]).find_client(token) is client
    assert token not in entry
    with pytest.raises(ValueError, match="pattern"):
        rights_entry("../x", token)


@pytest.mark.parametrize(
    ("pattern", "name", "matches"),
    [
        ("/a/*", "/a/b", True),
        ("/a/*", "/a/b/c", True),
        ("/a/*", "/ab", False),
        ("/a/*", "/a", False),
        ("/*", "/anything", True),
        ("/a", "/a", True),
        ("/a", "/a/b", False),
        ("/a:*", "/a:b.c", True),
        ("/a:*", "/a/b:c", False),
        ("/a:b", "/a:b", True),
        ("/a:b", "/a:bc", False),
        ("/a/*", "/a:b", False),
    ],
)
def test_patterns_of_names(pattern, name, matches):
    assert matches_name(pattern, name) is matches


@pytest.mark.parametrize(
    ("one", "other", "same"),
    [
        ("std_msgs/String", "std_msgs/msg/String", True),
        ("std_srvs/srv/Empty", "std_srvs/Empty", True),
        ("std_msgs/String", "std_msgs/Bool", False),
    ],
)
def test_spellings_of_types(one, other, same):
    assert same_type(one, other) is same


def test_rights_that_fit_the_plan():
    check_rights(rights(), plan())


def test_rights_that_the_plan_does_not_give_are_told():
    unfit = f"""schema: rtron.bridge/1
clients:
  - name: tab
    tokens: ["{HASH}"]
    publish:
      - {{topic: /cmd_vel, type: geometry_msgs/Twist}}
      - {{topic: /other_vel, type: geometry_msgs/msg/TwistStamped}}
"""
    with pytest.raises(InputError) as raised:
        check_rights(parse_rights(unfit), plan())
    text = str(raised.value)
    assert "tab: the plan guards /cmd_vel and has no flow of /bridge/tab" in text
    assert "tab: /other_vel moves the robot, and no plan guards it" in text


@pytest.mark.parametrize("ros", [1, 2])
@pytest.mark.parametrize(
    ("group", "type", "message"),
    [
        ("publish", "std_msgs/Int8", "tab: /chat is std_msgs/Int8 here, std_msgs/String for web"),
        ("subscribe", "a/msg/B", "tab: /chat is a/msg/B here, std_msgs/String for web"),
        ("publish", "std_msgs/msg/String", ""),
    ],
)
def test_a_topic_has_one_type_for_all_clients(ros, group, type, message):
    unfit = (
        RIGHTS
        + f"""  - name: tab
    tokens: ["{HASH}"]
    {group}: [{{{{topic: /chat, type: {type}}}}}]
"""
    )
    if not message:
        check_rights(rights(unfit), plan(ros))
        return
    with pytest.raises(InputError) as raised:
        check_rights(rights(unfit), plan(ros))
    assert message in str(raised.value)


def test_a_guarded_action_of_ros_2_is_that_of_the_client_s_flow():
    guarded = (
        PLAN.format(ros=2)
        .replace("/cmd_vel", "/dock")
        .replace("type: geometry_msgs/Twist", "type: a/action/Dock")
    )
    topics = PlanTopics(parse_plan(guarded.replace("kind: command", "kind: action")))
    assert topics.action("/bridge/web", "/dock") == "/rtron/dock/web"
    assert topics.action("/bridge/tab", "/undock") == "/undock"
    with pytest.raises(WireError, match="the plan guards /dock and has no flow of /bridge/tab"):
        topics.action("/bridge/tab", "/dock")


def test_the_example_of_the_page_is_right():
    page = Path(__file__).parents[3] / "docs" / "bridge.md"
    found = re.findall(r"```yaml\n(.*?)```", page.read_text("utf-8"), re.DOTALL)
    rights_text, plan_text = map(textwrap.dedent, found)
    check_rights(parse_rights(rights_text), parse_plan(plan_text))


def test_what_moves_no_robot_needs_no_plan():
    topics = PlanTopics(plan())
    assert topics.published("/bridge/tab", "/volume", "std_msgs/Float64") == "/volume"


def test_who_looks_on_reads_the_public_topic_and_the_base_its_private_one():
    topics = PlanTopics(plan())
    assert topics.subscribed("/bridge/tab", "/cmd_vel") == "/cmd_vel"
    assert topics.subscribed("/base", "/cmd_vel") == "/rtron/cmd_vel/out"


def test_where_strangers_may_publish_a_client_still_needs_a_flow():
    unplanned = PLAN.format(ros=1).replace("policy: P", "block_unapproved: false\n    policy: P")
    topics = PlanTopics(parse_plan(unplanned))
    assert topics.published("/bridge/web", "/cmd_vel", "geometry_msgs/Twist").endswith("/web")
    with pytest.raises(WireError, match="has no flow of /bridge/tab"):
        topics.published("/bridge/tab", "/cmd_vel", "geometry_msgs/Twist")
