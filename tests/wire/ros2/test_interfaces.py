"""Types that strangers name: only what the ament index lists is read, and all of it is bounded."""

import pytest

from rtron.errors import SourceError
from rtron.messages.common.definition_parser import MAX_TEXT
from rtron.wire.ros2.interfaces import find_interface

INDEX = "share/ament_index/resource_index/rosidl_interfaces"


class Workspace:
    """A prefix in which a test installs packages."""

    def __init__(self, prefix):
        self.prefix = prefix

    def install(self, package, python="", listed=(), **texts):
        """Install messages, listed in the index unless `listed` says what is instead."""
        index = self.prefix / INDEX / package
        index.parent.mkdir(parents=True, exist_ok=True)
        index.write_text("\n".join(listed or [f"msg/{name}.msg" for name in texts]))
        for name, text in texts.items():
            file = self.prefix / "share" / package / "msg" / f"{name}.msg"
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_text(text)
        module = self.prefix / "python" / package
        module.mkdir(parents=True)
        classes = python or "\n".join(f"class {name}: pass" for name in texts)
        (module / "__init__.py").touch()
        (module / "msg.py").write_text(classes)


@pytest.fixture
def workspace(tmp_path, monkeypatch):
    """Have a workspace sourced, and nothing kept of those before."""
    monkeypatch.setenv("AMENT_PREFIX_PATH", f"/nowhere::{tmp_path}")
    monkeypatch.syspath_prepend(tmp_path / "python")
    find_interface.cache_clear()
    yield Workspace(tmp_path)
    find_interface.cache_clear()


def refused(type):
    with pytest.raises(SourceError) as error:
        find_interface(type)
    return f"{error.value} | {error.value.help}"


def test_all_types_in_a_type(workspace):
    workspace.install(
        "aa_msgs", A="bb_msgs/B[] b\nInner i\nbuiltin_interfaces/Time t", Inner="int8 x"
    )
    workspace.install("bb_msgs", B="aa_msgs/Inner i")
    found = find_interface("aa_msgs/A")
    assert found.definition.count("MSG: aa_msgs/Inner") == 1
    assert "MSG: bb_msgs/B" in found.definition
    assert (found.type, found.cls.__name__, found.type_hash) == ("aa_msgs/msg/A", "A", "")
    assert find_interface("aa_msgs/A") is found


def test_the_hash_of_the_installed_description(workspace):
    workspace.install("cc_msgs", C="int8 x", D="int8 x")
    folder = workspace.prefix / "share/cc_msgs/msg"
    hashes = '{"type_hashes": [{"type_name": "cc_msgs/msg/%s", "hash_string": "RIHS01_1"}]}'
    (folder / "C.json").write_text(hashes % "C")
    (folder / "D.json").write_text(hashes % "C")
    assert find_interface("cc_msgs/msg/C").type_hash == "RIHS01_1"
    assert find_interface("cc_msgs/msg/D").type_hash == ""


@pytest.mark.parametrize(
    "text", ["", "[]", "{}", '{"type_hashes": 1}', '{"type_hashes": [1]}', "{" * 9]
)
def test_a_description_that_is_none(workspace, text):
    workspace.install("dd_msgs", D="int8 x")
    (workspace.prefix / "share/dd_msgs/msg/D.json").write_text(text)
    assert find_interface("dd_msgs/D").type_hash == ""


@pytest.mark.parametrize(
    "type",
    [
        "",
        "String",
        "std_msgs/msg/../String",
        "../../etc/msg/Passwd",
        "std_msgs/msg/String\n",
        "std_msgs//String",
        "std_msgs/idl/String",
        "Std_msgs/String",
        "std_msgs.msg/String",
        "std_msgs/string",
        "std_msgs/__init__",
        "stdä/String",
        "a" * 200 + "/B",
        "a/" + "B" * 100_000,
    ],
)
def test_names_that_are_none(workspace, type):
    assert "is not a type of ROS 2 | it is pkg/msg/Name" in refused(type)
    assert len(refused(type)) < 200


def test_what_is_not_listed_is_not_imported(workspace):
    """Not even if there is such a module, or such a file."""
    workspace.install("ee_msgs", python="raise SystemExit", listed=["msg/F.msg"], E="int8 x")
    assert "install the package ee_msgs" in refused("ee_msgs/E")
    assert "os/msg/Path is not installed here" in refused("os/Path")


def test_the_first_of_two_installations_counts(workspace, monkeypatch, tmp_path):
    """What an overlay does not have, is not looked for in what it hides."""
    workspace.install("ff_msgs", F="int8 x")
    over = tmp_path / "over"
    (over / INDEX).mkdir(parents=True)
    (over / INDEX / "ff_msgs").write_text("msg/G.msg")
    monkeypatch.setenv("AMENT_PREFIX_PATH", f"{over}:{tmp_path}")
    assert "ff_msgs/msg/F is not installed" in refused("ff_msgs/F")


@pytest.mark.parametrize("python", ["class Other: pass", "G = 1", "import nowhere_at_all"])
def test_what_python_cannot_import(workspace, monkeypatch, python):
    package = f"gg{abs(hash(python))}_msgs"
    workspace.install(package, python=python, G="int8 x")
    assert f"{package}/msg/G" in refused(f"{package}/G")


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("wstring x", "wstring is no type"),
        ("float64", "neither a field nor a constant"),
        ("hh_msgs/H x", "contains itself"),
        ("Nothing x", "hh_msgs/msg/Nothing is not installed here"),
        ("../x/Y y", "neither a field"),
        ("#" * (MAX_TEXT + 1), "is longer than"),
        ("#" * MAX_TEXT + "\nint8 x", "is longer than"),
    ],
)
def test_definitions_that_cannot_be_used(workspace, text, said):
    workspace.install("hh_msgs", H=text)
    assert said in refused("hh_msgs/H")


def test_definitions_that_are_too_long_together(workspace):
    half = "#" * (MAX_TEXT // 2) + "\n"
    workspace.install("ii_msgs", I=f"{half}J j", J=f"{half}int8 x")
    assert f"exceeds {MAX_TEXT} characters" in refused("ii_msgs/I")


def test_a_listed_type_whose_file_is_gone(workspace):
    workspace.install("jj_msgs", J="int8 x")
    (workspace.prefix / "share/jj_msgs/msg/J.msg").unlink()
    assert "no definition of jj_msgs/msg/J can be read" in refused("jj_msgs/J")
