"""A client's session: what it may do is done, and everything else is refused with a reason."""

import json

import pytest
from bridge_parts import RIGHTS, WALL, Talk, frames, reason
from hypothesis import given
from hypothesis import strategies as st
from message_samples import encode, make

from rtron.bridge.protocol import effects
from rtron.bridge.protocol.frames import MAX_DEPTH
from rtron.errors import SourceError
from rtron.messages import Encoding
from rtron.messages.common.json_encoder import encode_json
from rtron.vocabulary import SECOND

TWIST = {"linear": {"x": 0.5, "y": 0.0, "z": 0.0}, "angular": {"x": 0.0, "y": 0.0, "z": 0.1}}
PRIVATE = "/rtron/cmd_vel/web"
OPERATIONS = (
    *("publish", "subscribe", "unsubscribe", "advertise", "unadvertise"),
    *("fragment", "call_service", "set_level", "png", "x"),
)


def text(value, talk):
    definition = talk.types.message("std_msgs/String")
    return encode_json(definition, talk.types.encoding, {"data": value}, WALL, 1 << 20)[0]


def publish(talk, topic="/chat", msg=None, **more):
    return talk.say("publish", topic=topic, msg={"data": "hi"} if msg is None else msg, **more)


def kinds(decided):
    return [type(each).__name__ for each in decided]


def read_chat(talk, **options):
    decided = talk.say("subscribe", topic="/chat", type="std_msgs/String", **options)
    assert decided == [effects.ReadTopic("/chat", "std_msgs/String")]


# Topics: publishing.


def test_a_command_goes_to_the_flow_that_the_plan_gives_the_client():
    talk = Talk()
    assert talk.say("advertise", topic="/cmd_vel", type="geometry_msgs/Twist") == [
        effects.AdvertiseTopic(PRIVATE, "geometry_msgs/Twist", ("/rtron/gr_base",))
    ]
    (published,) = publish(talk, "/cmd_vel", TWIST)
    linear = make(Encoding.ROS1, "geometry_msgs/Vector3", 0.5, 0.0, 0.0)
    angular = make(Encoding.ROS1, "geometry_msgs/Vector3", 0.0, 0.0, 0.1)
    expected = make(Encoding.ROS1, "geometry_msgs/Twist", linear, angular)
    assert published == effects.PublishBytes(
        PRIVATE, encode(Encoding.ROS1, "geometry_msgs/Twist", expected)
    )


def test_no_effect_ever_names_the_topic_that_the_base_reads():
    talk = Talk()
    decided = [*publish(talk, "/cmd_vel", TWIST), *publish(talk, "/rtron/cmd_vel/out", TWIST)]
    assert {each.topic for each in decided if hasattr(each, "topic")} == {PRIVATE}


def test_a_name_without_a_slash_is_below_the_root():
    assert kinds(publish(Talk(), "chat")) == ["AdvertiseTopic", "PublishBytes"]
    (told,) = frames(Talk().say("call_service", service="rosapi/services"))
    assert told["values"] == {"services": ["/lamp"]}


def test_a_client_need_not_advertise_first():
    assert kinds(publish(Talk())) == ["AdvertiseTopic", "PublishBytes"]


def test_latching_is_the_client_s_to_ask_for():
    talk = Talk()
    assert publish(talk, latch=True)[-1].is_latched
    assert not publish(talk, latch="yes")[-1].is_latched


def test_what_is_advertised_can_be_withdrawn():
    talk = Talk()
    publish(talk)
    assert talk.say("unadvertise", topic="/chat") == [effects.WithdrawTopic("/chat")]
    assert talk.say("unadvertise", topic="/chat") == []
    talk.say("set_level", level="warning")
    (told,) = frames(talk.say("unadvertise", topic="/chat"))
    assert (told["level"], told["msg"]) == ("warning", "you do not publish /chat")


@pytest.mark.parametrize(
    ("op", "fields", "why"),
    [
        ("publish", {"topic": "/odom", "msg": {}}, "web may not publish /odom"),
        ("publish", {"topic": "/cmd_vel/", "msg": {}}, "web may not publish /cmd_vel/"),
        ("publish", {"topic": "scan", "msg": {}}, "web may not publish /scan"),
        ("publish", {"topic": "~cmd_vel", "msg": {}}, "web may not publish /~cmd_vel"),
        ("publish", {"topic": "//cmd_vel", "msg": {}}, "web may not publish //cmd_vel"),
        ("publish", {"topic": PRIVATE, "msg": {}}, f"web may not publish {PRIVATE}"),
        ("publish", {"msg": {}}, "publish needs `topic`, a text"),
        ("publish", {"topic": ["/chat"], "msg": {}}, "publish needs `topic`, a text"),
        ("publish", {"topic": "/chat", "msg": []}, "std_msgs/String is an object, not a list"),
        ("publish", {"topic": "/chat", "msg": None}, "std_msgs/String is an object, not null"),
        ("publish", {"topic": "/chat", "msg": {"text": ""}}, "no field 'text'"),
        ("publish", {"topic": "/chat", "msg": {"data": 5}}, "data is a string, not '5'"),
        (
            "publish",
            {"topic": "/cmd_vel", "msg": {"linear": {"x": 1e400}}},
            "Infinity is no number",
        ),
        ("publish", {"topic": "/cmd_vel", "msg": {"linear": {"x": "1"}}}, "linear.x is a number"),
        ("publish", {"topic": "/cmd_vel", "msg": {"linear": 1}}, "linear is an object, not '1'"),
        ("advertise", {"topic": "/chat"}, "advertise needs `type`, a text"),
        ("advertise", {"topic": "/chat", "type": "std_msgs/Int8"}, "is of type std_msgs/String"),
        ("advertise", {"topic": "/new", "type": "std_msgs/Int8"}, "web may not publish /new"),
        ("subscribe", {"topic": "/scan"}, "web may not read /scan"),
        ("subscribe", {"topic": "/rosout"}, "web may not read /rosout"),
        ("subscribe", {"topic": "/odom", "type": "std_msgs/Int8"}, "is of type nav_msgs/Odometry"),
        ("subscribe", {"topic": "/odom", "compression": "cbor-raw"}, "no compression"),
        ("unsubscribe", {"topic": "/odom"}, "you do not read /odom"),
        ("set_level", {"level": "all"}, "the level is one of"),
        ("set_level", {"level": ["info"]}, "the level is one of"),
        ("png", {"data": "iVBORw0KGgo="}, "a picture may unpack to any size"),
        ("advertise_service", {"service": "/s", "type": "a/B"}, "clients offer no services"),
        ("service_response", {"service": "/s", "values": {}}, "clients offer no services"),
        ("cancel_action_goal", {"action": "/a", "id": "x"}, "you have no goal 'x' of /a"),
        ("auth", {"mac": "x"}, "you are signed in"),
        ("shutdown", {}, "there is no operation 'shutdown'"),
        ("__init__", {}, "there is no operation '__init__'"),
        ("fragment", {"data": "x"}, "a fragment needs the `id`"),
    ],
)
def test_what_is_refused_has_a_reason_and_no_effect(op, fields, why):
    talk = Talk()
    assert why in talk.refusal(op, **fields)
    assert talk.session.refused == 1


def test_a_number_that_is_too_large_for_json_is_refused():
    talk = Talk()
    frame = '{"op": "publish", "topic": "/cmd_vel", "msg": {"linear": {"x": 1e999}}}'
    assert "1e999 is larger than any number" in reason(talk.send(frame))


def test_a_refusal_has_the_id_of_what_is_refused():
    (told,) = frames(Talk().say("publish", id="p:1", topic="/x", msg={}))
    assert told["id"] == "p:1"


def test_a_warning_names_what_was_left_out():
    talk = Talk()
    talk.say("set_level", level="warning")
    told = frames(publish(talk, "/cmd_vel", {"linear": {"x": 1.0}}))
    assert [each["level"] for each in told] == ["warning"]
    assert "linear.y, linear.z, angular" in told[0]["msg"]


def test_a_client_that_wants_no_status_gets_none():
    talk = Talk()
    talk.say("set_level", level="none")
    assert talk.say("subscribe", topic="/scan") == []
    assert talk.session.refused == 1


def test_success_is_told_to_who_wants_it():
    talk = Talk()
    talk.say("set_level", level="info")
    told = frames(talk.say("subscribe", id="s", topic="/chat"))
    assert told == [{"op": "status", "level": "info", "msg": "you read /chat", "id": "s"}]


# Rates and sizes.


def test_a_topic_has_its_rate():
    talk = Talk()
    assert [kinds(publish(talk))[-1] for _ in range(2)] == ["PublishBytes"] * 2
    assert reason(publish(talk)) == "/chat: more than 10 messages a second"
    talk.now += 99_999_999
    assert publish(talk) == []
    talk.now += 1
    assert kinds(publish(talk)) == ["PublishBytes"]
    assert kinds(publish(talk, "/cmd_vel", TWIST))[-1] == "PublishBytes"


def test_who_comes_again_has_the_rates_of_before():
    talk = Talk()
    assert [kinds(publish(talk))[-1] for _ in range(2)] == ["PublishBytes"] * 2
    talk.come_again()
    assert reason(publish(talk)) == "/chat: more than 10 messages a second"
    talk.now += SECOND // 10
    assert kinds(publish(talk))[-1] == "PublishBytes"


def test_who_is_disconnected_for_going_too_fast_is_so_again():
    talk = Talk()
    while "CloseSession" not in kinds(talk.send("nonsense")):
        pass
    talk.come_again()
    assert "CloseSession" in kinds(talk.send("nonsense"))


def test_the_same_reason_is_told_once_a_second_with_a_count():
    talk = Talk()
    told = [frames(publish(talk)) for _ in range(20)]
    assert [len(each) for each in told] == [0, 0, 1] + [0] * 17
    talk.wait(1.0)
    told = [frame for _ in range(3) for frame in frames(publish(talk))]
    assert [each["msg"] for each in told] == [
        "/chat: more than 10 messages a second (17 times more meanwhile)"
    ]


def test_frames_have_their_rate_whatever_is_in_them():
    talk = Talk()
    told = [frames(talk.send("nonsense")) for _ in range(51)]
    assert "not JSON" in told[0][0]["msg"]
    assert told[50][0]["msg"] == "more than 100 frames or 100000 bytes a second"


@pytest.mark.parametrize("data", ["x" * 9900, "€" * 3300])
def test_bytes_have_their_rate(data):
    talk = Talk()
    document = {"op": "publish", "topic": "/chat", "msg": {"data": data}}
    long = json.dumps(document, ensure_ascii=False)
    assert kinds(talk.send(long)) == ["AdvertiseTopic", "PublishBytes"]
    told = [frame["msg"] for _ in range(12) for frame in frames(talk.send(long))]
    assert told == [
        "/chat: more than 10 messages a second",
        "more than 100 frames or 100000 bytes a second",
    ]


def test_who_goes_on_too_fast_is_disconnected():
    talk = Talk()
    decided = [each for _ in range(560) for each in talk.send("x")]
    assert effects.CloseSession not in map(type, decided[:1])
    assert [each for each in decided if isinstance(each, effects.CloseSession)]


def test_pings_count_as_frames():
    talk = Talk()
    decided = [each for _ in range(560) for each in talk.session.note_control(talk.now)]
    assert isinstance(decided[0], effects.SendAnswer)
    assert [each for each in decided if isinstance(each, effects.CloseSession)]


def test_a_client_that_keeps_to_its_limits_is_never_disconnected():
    talk = Talk()
    for _ in range(2000):
        assert effects.CloseSession not in map(type, publish(talk))
        talk.wait(0.01)


def test_a_message_has_its_size():
    talk = Talk()
    long = "x" * 10_001
    assert "you send at most 10000" in talk.refusal("publish", topic="/chat", msg={"data": long})
    euros = json.dumps({"op": "publish", "topic": "/chat", "msg": {"data": "€" * 4000}})
    told = reason(talk.send(euros.replace("\\u20ac", "€")))
    assert told == "the frame has 12056 bytes, you send at most 10000"


def test_changes_of_the_graph_have_their_rate():
    talk = Talk()
    told = []
    for _ in range(60):
        talk.now += 60_000_000
        told += frames(talk.say("subscribe", topic="/chat"))
        talk.now += 60_000_000
        told += frames(talk.say("unsubscribe", topic="/chat"))
    assert told == []
    for _ in range(200):
        talk.now += 10_000_000
        told += frames(talk.say("subscribe", topic="/chat"))
        talk.now += 10_000_000
        told += frames(talk.say("unsubscribe", topic="/chat"))
    assert "more than 10 new topics a second" in told[0]["msg"]


# Fragments.


def test_an_operation_may_come_in_fragments():
    talk = Talk()
    whole = json.dumps({"op": "publish", "topic": "/chat", "msg": {"data": "x" * 100}})
    parts = [whole[:40], whole[40:]]
    decided = [
        talk.say("fragment", id="f", num=n, total=2, data=each) for n, each in enumerate(parts)
    ]
    assert kinds(decided[0]) == []
    assert kinds(decided[1]) == ["AdvertiseTopic", "PublishBytes"]


def test_a_fragment_of_fragments_is_refused():
    inner = json.dumps({"op": "fragment", "id": "a", "num": 0, "total": 1, "data": "x"})
    assert "a fragment of fragments" in Talk().refusal(
        "fragment", id="f", num=0, total=1, data=inner
    )


def test_a_png_in_fragments_is_refused_too():
    inner = json.dumps({"op": "png", "data": "x"})
    assert "png is refused" in Talk().refusal("fragment", id="f", num=0, total=1, data=inner)


# Topics: reading.


def test_a_message_is_sent_to_who_reads_its_topic():
    talk = Talk()
    read_chat(talk)
    decided = talk.deliver("/chat", text("hi", talk))
    assert kinds(decided) == ["SendMessage"]
    assert frames(decided) == [{"op": "publish", "topic": "/chat", "msg": {"data": "hi"}}]


def test_a_topic_that_nobody_reads_is_sent_to_nobody():
    talk = Talk()
    assert talk.deliver("/chat", text("hi", talk)) == []
    read_chat(talk)
    assert talk.say("unsubscribe", topic="/chat") == [effects.LeaveTopic("/chat")]
    assert talk.deliver("/chat", text("hi", talk)) == []


def test_two_subscriptions_to_a_topic_are_one_in_the_graph():
    talk = Talk()
    read_chat(talk, id="a")
    assert talk.say("subscribe", topic="/chat", id="b") == []
    assert talk.say("unsubscribe", topic="/chat", id="a") == []
    assert talk.say("unsubscribe", topic="/chat", id="b") == [effects.LeaveTopic("/chat")]


def test_a_message_is_sent_in_fragments_or_as_a_picture():
    talk = Talk()
    read_chat(talk, fragment_size=200)
    decided = talk.deliver("/chat", text("x" * 500, talk))
    parts = frames(decided)
    assert {each["op"] for each in parts} == {"fragment"}
    whole = "".join(each["data"] for each in sorted(parts, key=lambda each: each["num"]))
    assert json.loads(whole)["msg"]["data"] == "x" * 500
    picture = Talk()
    read_chat(picture, compression="png")
    assert frames(picture.deliver("/chat", text("hi", picture)))[0]["op"] == "png"


def test_a_message_that_waits_is_sent_when_its_time_has_come():
    talk = Talk()
    read_chat(talk, throttle_rate=200, queue_length=1)
    assert len(talk.deliver("/chat", text("1", talk))) == 1
    assert talk.deliver("/chat", text("2", talk)) == []
    assert talk.session.next_tick == talk.now + 200_000_000
    assert frames(talk.wait(0.2))[0]["msg"] == {"data": "2"}
    assert talk.session.next_tick is None


def test_a_message_that_is_too_large_is_told_of_once():
    talk = Talk()
    read_chat(talk)
    (told,) = frames(talk.deliver("/chat", text("x" * 20_000, talk)))
    assert "a message of 20008 bytes is left out, you take at most 10000" in told["msg"]
    talk.now += 100_000_000
    assert talk.deliver("/chat", text("x" * 20_000, talk)) == []


def test_a_message_that_is_malformed_is_told_of():
    talk = Talk()
    read_chat(talk)
    (told,) = frames(talk.deliver("/chat", b"\xff\xff\xff\xff"))
    assert "bytes are announced" in told["msg"]


# Services.


def call(talk, **fields):
    return talk.say("call_service", service="/lamp", id="c:1", **fields)


def answer(decided):
    (found,) = [each for each in frames(decided) if each["op"] == "service_response"]
    return found


@pytest.mark.parametrize("args", [{"data": True}, [True]])
def test_a_call_and_its_answer(args):
    talk = Talk()
    (asked,) = call(talk, args=args)
    assert asked == effects.RequestService(1, "/lamp", "std_srvs/SetBool", b"\1\0\0\0\1")
    _, response = talk.types.service("std_srvs/SetBool")
    given = {"success": True, "message": "on"}
    decided = talk.session.finish_call(
        1, encode_json(response, Encoding.ROS1, given, WALL, 1000)[0]
    )
    assert answer(decided) == {
        "op": "service_response",
        "id": "c:1",
        "service": "/lamp",
        "values": given,
        "result": True,
    }
    assert talk.session.finish_call(1, b"") == []


@pytest.mark.parametrize(
    ("fields", "why"),
    [
        ({"service": "/shutdown"}, "web may not call /shutdown"),
        ({"service": "/rosapi/nodes"}, "web may not call /rosapi/nodes"),
        ({"service": "/rosapi/../lamp"}, "web may not call"),
        ({"service": "/lamp", "type": "std_srvs/Empty"}, "is of type std_srvs/SetBool"),
        ({"service": "/lamp", "args": {"on": True}}, "no field 'on'"),
        ({"service": "/lamp", "args": {"data": 1}}, "data is true or false"),
        ({"service": "/lamp", "args": [True, True]}, "has 1 fields, not 2"),
        ({"service": "/lamp", "args": "on"}, "is an object"),
        ({"service": "/rosapi/get_param", "args": {"name": "/base/x"}}, "may not read /base/x"),
        ({"service": "/rosapi/get_param", "args": {}}, "may not read None"),
        ({"service": "/rosapi/get_param", "args": [1]}, "takes an object"),
        ({"service": "/rosapi/set_param", "args": {"name": "/nav/x"}}, "may not write /nav/x"),
        ({"service": "/rosapi/delete_param", "args": {"name": "/nav/x"}}, "may not write /nav/x"),
        (
            {"service": "/rosapi/set_param", "args": {"name": "/nav/speed", "value": "NaN"}},
            "NaN is no number of JSON",
        ),
        (
            {"service": "/rosapi/set_param", "args": {"name": "/nav/speed", "value": "{"}},
            "the parameter's value is not JSON",
        ),
    ],
)
def test_a_call_that_is_refused_has_an_answer_and_a_status(fields, why):
    talk = Talk()
    decided = talk.say("call_service", id=7, **fields)
    assert why in reason(decided)
    told = answer(decided)
    assert (told["id"], told["result"]) == (7, False)
    assert why in told["values"]


def test_a_call_without_a_service_is_refused():
    assert "call_service needs `service`" in reason(Talk().say("call_service", id=7))


def test_only_a_few_calls_are_unanswered_at_a_time():
    talk = Talk()
    assert kinds(call(talk)) == ["RequestService"]
    talk.now += 200_000_000
    assert kinds(call(talk)) == ["RequestService"]
    talk.now += 200_000_000
    assert "2 of your calls are unanswered" in reason(call(talk))


def test_a_call_has_its_rate():
    talk = Talk()
    call(talk)
    assert "more than 5 calls a second" in reason(call(talk))


def test_a_call_that_nobody_answers_ends():
    talk = Talk()
    call(talk)
    assert talk.session.next_tick == talk.now + 3_000_000_000
    assert talk.wait(2.9) == []
    told = answer(talk.wait(0.2))
    assert (told["result"], told["values"]) == (False, "no answer within 3 s")
    assert talk.session.finish_call(1, b"\0\0\0\0") == []
    assert kinds(call(talk)) == ["RequestService"]


@pytest.mark.parametrize(
    ("given", "why"),
    [
        (SourceError("nobody offers /lamp"), "nobody offers /lamp"),
        (b"\x01\x00\x00\x00\x01", "the message ends before"),
        (b"\x10\x27\x00\x00" + bytes(10_000), "the answer has 10004 bytes"),
    ],
)
def test_an_answer_that_is_none_is_told(given, why):
    talk = Talk()
    call(talk)
    told = answer(talk.session.finish_call(1, given))
    assert told["result"] is False
    assert why in told["values"]


def test_an_answer_may_come_in_fragments():
    talk = Talk()
    call(talk, fragment_size=128)
    _, response = talk.types.service("std_srvs/SetBool")
    long = encode_json(response, Encoding.ROS1, {"message": "x" * 900}, WALL, 9999)[0]
    assert {each["op"] for each in frames(talk.session.finish_call(1, long))} == {"fragment"}


# rosapi tells only what the client may know.


def rosapi(talk, name, **args):
    return answer(talk.say("call_service", service=f"/rosapi/{name}", args=args))["values"]


def test_rosapi_lists_what_the_client_may_use_and_nothing_else():
    talk = Talk()
    assert rosapi(talk, "topics")["topics"] == ["/cmd_vel", "/chat", "/odom"]
    assert rosapi(talk, "topics_for_type", type="std_msgs/String") == {"topics": ["/chat"]}
    assert rosapi(talk, "topic_type", topic="/odom") == {"type": "nav_msgs/Odometry"}
    assert rosapi(talk, "topic_type", topic="/scan") == {"type": ""}
    assert rosapi(talk, "services") == {"services": ["/lamp"]}
    assert rosapi(talk, "service_type", service="/lamp") == {"type": "std_srvs/SetBool"}
    assert rosapi(talk, "service_type", service="/x") == {"type": ""}
    assert rosapi(talk, "get_time") == {"time": {"secs": 1_700_000_000, "nsecs": 0}}
    screen = Talk("screen")
    assert rosapi(screen, "topics")["topics"] == ["/chat"]
    assert rosapi(screen, "services") == {"services": []}


def test_rosapi_describes_the_types_of_what_the_client_may_use():
    talk = Talk()
    odometry, *others = rosapi(talk, "message_details", type="nav_msgs/msg/Odometry")["typedefs"]
    assert odometry["type"] == "nav_msgs/Odometry"
    assert odometry["fieldnames"] == ["header", "child_frame_id", "pose", "twist"]
    assert odometry["fieldtypes"][:2] == ["std_msgs/Header", "string"]
    lengths = {each["type"]: each["fieldarraylen"] for each in others}
    assert lengths["geometry_msgs/PoseWithCovariance"] == [-1, 36]
    (request,) = rosapi(talk, "service_request_details", type="std_srvs/SetBool")["typedefs"]
    assert (request["fieldnames"], request["fieldtypes"]) == (["data"], ["bool"])
    (response,) = rosapi(talk, "service_response_details", type="std_srvs/SetBool")["typedefs"]
    assert response["fieldnames"] == ["success", "message"]
    assert rosapi(talk, "action_servers") == {"action_servers": []}


@pytest.mark.parametrize(
    ("name", "why"),
    [
        ("message_details", "web has no topic of type sensor_msgs/LaserScan"),
        ("service_request_details", "web calls no service of type sensor_msgs/LaserScan"),
        ("service_response_details", "web calls no service of type sensor_msgs/LaserScan"),
    ],
)
def test_rosapi_describes_no_other_type(name, why):
    assert why in rosapi(Talk(), name, type="sensor_msgs/LaserScan")


def test_parameters_are_read_and_written_within_the_rights():
    talk = Talk()
    asked = talk.say("call_service", service="/rosapi/get_param", args={"name": "/nav/a/b"}, id=1)
    assert asked == [effects.RequestParameter(1, effects.ParameterVerb.GET, "/nav/a/b")]
    assert answer(talk.session.finish_call(1, {"value": "1.5"}))["values"] == {"value": "1.5"}
    talk.wait(1)
    args = {"name": "/nav/speed", "value": "[1, 2]"}
    asked = talk.say("call_service", service="/rosapi/set_param", args=args)
    assert asked == [effects.RequestParameter(2, effects.ParameterVerb.SET, "/nav/speed", [1, 2])]


@pytest.mark.parametrize("depth", [MAX_DEPTH + 1, 4000])
def test_the_value_of_a_parameter_is_not_nested_deeper_than_a_frame(depth):
    args = {"name": "/nav/speed", "value": "[" * depth + "]" * depth}
    decided = Talk().say("call_service", service="/rosapi/set_param", args=args)
    assert "nested deeper" in answer(decided[:1])["values"]
    assert "nested deeper" in reason(decided)


# Everything at once.


@given(
    st.lists(
        st.fixed_dictionaries(
            {"op": st.sampled_from(OPERATIONS)},
            optional={
                "topic": st.sampled_from(["/cmd_vel", "/chat", "/odom", "/x", "", 5]),
                "service": st.sampled_from(["/lamp", "/rosapi/topics", "/rosapi/get_param", "/x"]),
                "type": st.sampled_from(["std_msgs/String", "geometry_msgs/Twist", None, 5]),
                "msg": st.sampled_from([{}, {"data": "x"}, TWIST, None, [], {"data": None}]),
                "args": st.sampled_from([{}, [], {"name": "/nav/x"}, "x", None, {"data": True}]),
                "id": st.sampled_from(["a", 1, None, [], "b"]),
                "num": st.integers(-1, 3),
                "total": st.integers(0, 3),
                "data": st.sampled_from(['{"op":"x"}', "{", ""]),
                "level": st.sampled_from(["none", "error", "info", 5]),
                "throttle_rate": st.integers(-1, 1000),
                "queue_length": st.integers(-1, 100),
            },
        ),
        max_size=30,
    )
)
def test_whatever_comes_nothing_is_done_that_the_rights_do_not_give(documents):
    talk = Talk()
    for document in documents:
        decided = [*talk.send(json.dumps(document)), *talk.wait(0.02)]
        for each in decided:
            if isinstance(each, (effects.AdvertiseTopic, effects.PublishBytes)):
                assert each.topic in (PRIVATE, "/chat")
            elif isinstance(each, effects.ReadTopic):
                assert each.topic in ("/odom", "/chat")
            elif isinstance(each, effects.RequestService):
                assert each.service == "/lamp"
            elif isinstance(each, effects.RequestParameter):
                assert each.name == "/nav/x"
        frames(decided)


def test_actions_of_ros_1_are_five_topics():
    dock = "{{action: /dock, type: actionlib_tutorials/FibonacciAction}}"
    actions = RIGHTS.replace("    parameters:", f"    actions: [{dock}]\n    parameters:", 1)
    talk = Talk(text=actions)
    listed = rosapi(talk, "topics")
    known = dict(zip(listed["topics"], listed["types"], strict=True))
    assert known["/dock/goal"] == "actionlib_tutorials/FibonacciActionGoal"
    assert known["/dock/cancel"] == "actionlib_msgs/GoalID"
    assert known["/dock/status"] == "actionlib_msgs/GoalStatusArray"
    assert "web may not publish /dock/result" in talk.refusal(
        "publish", topic="/dock/result", msg={}
    )
    assert "web may not read /dock/goal" in talk.refusal("subscribe", topic="/dock/goal")
