"""Definitions: MD5 sums as ROS computes them, both spellings, and everything hostile refused."""

import hashlib
import json
import subprocess

import pytest
from hypothesis import given
from hypothesis import strategies as st
from message_samples import ROS1, ROS2
from rosbags.typesys import Stores, get_typestore

from rtron.errors import InputError
from rtron.messages import DefinitionRegistry, Field, parse_definition
from rtron.messages.common.definition_parser import MAX_DEPTH, MAX_FIELDS, MAX_TEXT, MAX_VALUES
from rtron.messages.common.definition_registry import standard_names, standard_text
from rtron.vocabulary import MessageDefinition

STORES = [each for each in Stores if each is not Stores.EMPTY]
DEBIAN = """
import importlib, json
found = {}
for package in ("geometry_msgs", "nav_msgs", "sensor_msgs", "std_msgs", "actionlib_msgs"):
    module = importlib.import_module(package + ".msg")
    for each in vars(module).values():
        if hasattr(each, "_md5sum"):
            found[each._type] = [each._md5sum, each._full_text]
print(json.dumps(found))
"""


@pytest.mark.parametrize(
    ("type", "md5sum"),
    [
        ("geometry_msgs/Twist", "9f195f881246fdfa2798d1d3eebca84a"),
        ("std_msgs/String", "992ce8a1687cec8c8bd883ec73ca41d1"),
        ("geometry_msgs/PoseStamped", "d3812c3cbc69362b77dc0b19b345f8f5"),
        ("geometry_msgs/msg/PoseStamped", "d3812c3cbc69362b77dc0b19b345f8f5"),
        ("ackermann_msgs/AckermannDrive", "3512e91b48d69674a0e86fadf1ea8231"),
        ("ackermann_msgs/AckermannDriveStamped", "1fd5d7f58889cefd44d29f6653240d0c"),
        ("std_msgs/Empty", "d41d8cd98f00b204e9800998ecf8427e"),
    ],
)
def test_known_md5sum(type, md5sum):
    assert DefinitionRegistry().find(type).md5sum == md5sum


@pytest.mark.parametrize("type", sorted(ROS1.fielddefs))
def test_md5sum_as_rosbags(type):
    assert DefinitionRegistry().find(type).md5sum == ROS1.generate_msgdef(type)[1]


def test_md5sums_as_debian():
    done = subprocess.run(
        ["/usr/bin/python3", "-c", DEBIAN], capture_output=True, text=True, check=False
    )
    if done.returncode:
        pytest.skip("Debian's ROS 1 message packages are not installed")
    found = json.loads(done.stdout)
    assert len(found) > 80
    for type, (md5sum, text) in found.items():
        assert parse_definition(type, text).md5sum == md5sum, type


@pytest.mark.parametrize("type", sorted(ROS2.fielddefs))
def test_ros2_definitions_are_read(type):
    assert DefinitionRegistry(ros=2).find(type).type == type.replace("/msg/", "/")


def test_header_of_either_generation():
    names = {
        ros: [each.name for each in DefinitionRegistry(ros=ros).find("std_msgs/Header").fields]
        for ros in (1, 2)
    }
    assert names == {1: ["seq", "stamp", "frame_id"], 2: ["stamp", "frame_id"]}


def test_every_spelling():
    text = """
# a comment
float64 x 1.5            # ROS 2: a default
string<=10 name "a = b"
int32[<=5] few
uint8[16] id
float32[] many
builtin_interfaces/Time at
duration lasts
Header header
b/msg/Inner inner
Other[2] others
string NOTE=  it's # here
int32 N = 0x10  # a constant
====
MSG: std_msgs/Header
time stamp
===
MSG: b/Inner
bool a
=====
MSG: a_msgs/Other
bool b
"""
    found = parse_definition("a_msgs/Thing", text)
    assert found.fields == (
        Field(name="x", type="float64"),
        Field(name="name", type="string", max_bytes=10),
        Field(name="few", type="int32", array=True, max_elements=5),
        Field(name="id", type="uint8", array=True, length=16),
        Field(name="many", type="float32", array=True),
        Field(name="at", type="time"),
        Field(name="lasts", type="duration"),
        Field(name="header", type="std_msgs/Header"),
        Field(name="inner", type="b/Inner"),
        Field(name="others", type="a_msgs/Other", array=True, length=2),
    )
    assert found.nested["std_msgs/Header"].find("stamp") == Field(name="stamp", type="time")
    assert found.find("nothing") is None


def test_bounds_make_another_type():
    """ROS 1 has no bounds, so its sums stay what they are."""
    texts = ["string[] x", "string<=3[] x", "string[<=3] x", "string<=3[<=3] x", "string[3] x"]
    sums = {parse_definition("a/B", text).md5sum for text in texts}
    assert len(sums) == len(texts)
    inner = "\n===\nMSG: a/C\nbool y"
    assert parse_definition("a/B", f"C[] x{inner}") != parse_definition("a/B", f"C[<=3] x{inner}")


def test_a_bound_that_bounds_nothing():
    found = parse_definition("a/B", f"string<={'9' * 5000} x\nint8[<={'9' * 11}] y")
    assert [(each.max_bytes, each.max_elements) for each in found.fields] == [(None, None)] * 2


def test_constants_count_as_spelled():
    """Another spelling of the same number is another type, in ROS as here."""
    one, other = (parse_definition("a/B", f"float32 X={value}\n").md5sum for value in ("1", "1.0"))
    assert one != other


def test_a_string_constant_keeps_what_looks_like_a_comment():
    with_hash = parse_definition("a/B", "string X= a # b \n").md5sum
    assert with_hash == hashlib.md5(b"string X=a # b").hexdigest()
    assert (
        parse_definition("a/B", "int8 X= 1 # b \n").md5sum == hashlib.md5(b"int8 X=1").hexdigest()
    )


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("float64", "line 1: neither a field nor a constant"),
        ("\nfloat64 1x", "line 2: neither"),
        ("float64 x; y", "line 1: neither"),
        ("float64[ x", "line 1: neither"),
        ("__import__('os') x", "line 1: neither"),
        ("a/b/c/d x", "line 1: neither"),
        ("wstring x", "line 1: wstring is no type"),
        ("int8<=3 x", "line 1: int8 of x is no string"),
        ("a/srv/B x", "line 1: a/srv/B is no type"),
        ("float64 x\nint8 x", "line 2: there are two fields x"),
        ("Nowhere x", "line 1: the type a/Nowhere of x is not defined"),
        ("float64[0] x", "x has 0 elements"),
        (f"float64[{MAX_VALUES + 1}] x", f"at most {MAX_VALUES}"),
        (f"float64[{'9' * 5000}] x", "at most"),
        ("B x", "contains itself: a/B -> a/B"),
        ("C x\n====\nMSG: a/C\nB y", "contains itself: a/B -> a/C -> a/B"),
        ("C x\n====\nMSG: a/C\nD y\n====\nMSG: a/D\nC y", "a/B -> a/C -> a/D -> a/C"),
        ("MSG: a/C", "line 1: neither"),
    ],
)
def test_refused(text, said):
    with pytest.raises(InputError) as refused:
        parse_definition("a/B", text)
    assert said in str(refused.value)


@pytest.mark.parametrize("type", ["", "a", "a/b/c", "a/", "/b", "a/1", "ä/b", "a/b\n", "../b"])
def test_no_type(type):
    with pytest.raises(InputError, match="is not a message type"):
        parse_definition(type, "")


def test_bound_of_text():
    parse_definition("a/B", "#" * MAX_TEXT)
    with pytest.raises(InputError, match="longer than"):
        parse_definition("a/B", "#" * (MAX_TEXT + 1))


def test_bound_of_fields():
    fields = [f"bool x{number}\n" for number in range(MAX_FIELDS)]
    assert len(parse_definition("a/B", "".join(fields)).fields) == MAX_FIELDS
    with pytest.raises(InputError, match="more than"):
        parse_definition("a/B", "".join([*fields, "bool X=1\n"]))


def chain(depth, array=""):
    """Return a text in which types are nested `depth` deep."""
    sections = [f"T{number + 1}{array} x\n" for number in range(1, depth)] + ["bool x\n"]
    return "".join(
        f"====\nMSG: a/T{number}\n{section}" if number > 1 else section
        for number, section in enumerate(sections, 1)
    )


def test_bound_of_depth():
    assert parse_definition("a/T1", chain(MAX_DEPTH)).depth == MAX_DEPTH
    for depth in (MAX_DEPTH + 1, 1000):
        with pytest.raises(InputError, match="nested deeper"):
            parse_definition("a/T1", chain(depth))


def test_bound_of_depth_with_what_others_define():
    deepest = parse_definition("a/T1", chain(MAX_DEPTH))
    with pytest.raises(InputError, match="nested deeper"):
        parse_definition("b/B", "a/T1 x", lookup=lambda _: deepest)


def test_bound_of_values():
    assert parse_definition("a/T1", chain(5, "[16]")).values == 16**4
    with pytest.raises(InputError, match="values"):
        parse_definition("a/T1", chain(6, "[16]"))


def test_types_that_branch_are_bounded():
    """Sixty fields of the next type, ten deep: small to write, 60^10 fields to lay out."""
    section = "".join(f"T{{}}[] x{number}\n" for number in range(60))
    text = "".join(f"====\nMSG: a/T{n}\n{section.format(*[n + 1] * 60)}" for n in range(1, 10))
    with pytest.raises(InputError, match="values"):
        parse_definition("a/T0", section.format(*[1] * 60) + text + "====\nMSG: a/T10\nbool x")


def test_own_definitions_come_first():
    own = MessageDefinition(type="std_msgs/msg/String", definition="float64 data")
    assert DefinitionRegistry([own]).find("std_msgs/String").fields[0].type == "float64"
    assert DefinitionRegistry().find("std_msgs/String").fields[0].type == "string"
    assert DefinitionRegistry().find("a/Unknown") is None


def test_own_definitions_know_each_other_and_the_standard_ones():
    """`rosmsg show -r` writes one type without those in it."""
    own = [
        MessageDefinition(type="a/One", definition="Two[] two\ngeometry_msgs/Pose pose\n"),
        MessageDefinition(type="a/Two", definition="bool x\n"),
    ]
    found = DefinitionRegistry(own).find("a/One")
    assert sorted(found.nested) == ["a/Two", "geometry_msgs/Pose"]


def test_own_definitions_that_contain_each_other():
    own = [
        MessageDefinition(type="a/One", definition="Two x"),
        MessageDefinition(type="a/Two", definition="One x"),
    ]
    with pytest.raises(InputError, match="a/One -> a/Two -> a/One"):
        DefinitionRegistry(own).find("a/One")


def test_own_definitions_too_deep():
    own = [
        MessageDefinition(type=f"a/T{n}", definition=f"T{n + 1} x" if n < 40 else "bool x")
        for n in range(41)
    ]
    known = DefinitionRegistry(own)
    for type in ("a/T0", "a/T20", "a/T0"):
        with pytest.raises(InputError, match="nested deeper"):
            known.find(type)
    assert known.find("a/T30").depth == 11


lines = st.lists(
    st.sampled_from(
        ["float64", "string", "a/B", "B", "Header", "time", "[", "]", "3", "<=", "=", "x", "y",
         "X=1", " ", "\n", "#", "====\n", "MSG: a/B\n", "\t", "\r\n", "\0", "ä", "'", '"']
    ),
    max_size=30,
)  # fmt: skip


@given(text=lines.map("".join) | st.text())
def test_fuzz_definition(text):
    try:
        found = parse_definition("a/B", text, lookup=DefinitionRegistry().find)
    except InputError:
        return
    assert found.type == "a/B"
    assert len(found.md5sum) == 32


@pytest.mark.parametrize("store", STORES, ids=lambda store: store.value)
def test_a_twist_is_the_same_in_every_distribution(store):
    ros = 1 if store is Stores.ROS1_NOETIC else 2
    text, _ = get_typestore(store).generate_msgdef("geometry_msgs/msg/Twist", ros_version=ros)
    assert standard_text("geometry_msgs/Twist", ros) == text


@pytest.mark.parametrize(
    ("distro", "ros", "has_variance"),
    [
        ("humble", 2, False),
        ("jazzy", 2, True),
        ("", 2, True),
        ("noetic", 2, True),
        ("humble", 1, False),
    ],
)
def test_the_standard_is_that_of_the_sourced_distribution(monkeypatch, distro, ros, has_variance):
    monkeypatch.setenv("ROS_DISTRO", distro)
    found = DefinitionRegistry(ros=ros).find("sensor_msgs/Range")
    assert (found.find("variance") is not None) is has_variance


def test_the_names_of_standard_messages_are_those_of_noetic_and_jazzy():
    stores = map(get_typestore, (Stores.ROS1_NOETIC, Stores.ROS2_JAZZY))
    types = {type for store in stores for type in store.types}
    packages = {type.partition("/")[0] for type in types}
    named = {f"{each}/msg/{name}" for each in packages for name in standard_names(each)}
    assert named == types
    assert standard_names("my_msgs") == frozenset()
