"""Types that are installed here are known without the plan; the plan's own count before them."""

import pytest

from rtron.errors import InputError
from rtron.guard.core.message_types import stamp_of
from rtron.guard.transport.common.protocol import TypeInfo
from rtron.messages.common.definition_registry import DefinitionRegistry
from rtron.messages.common.encoding import Encoding
from rtron.vocabulary import MessageDefinition

INDEX = "share/ament_index/resource_index/rosidl_interfaces"


@pytest.fixture
def install(tmp_path, monkeypatch):
    """Install interfaces of one package, in the only workspace that is sourced."""
    monkeypatch.setenv("AMENT_PREFIX_PATH", str(tmp_path))

    def install(package, kind="msg", **texts):
        index = tmp_path / INDEX / package
        index.parent.mkdir(parents=True, exist_ok=True)
        with index.open("a") as listed:
            listed.writelines(f"{kind}/{name}.{kind}\n" for name in texts)
        for name, text in texts.items():
            file = tmp_path / "share" / package / kind / f"{name}.{kind}"
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_text(text)

    return install


def fields(type, *own, ros=2):
    found = DefinitionRegistry(own, ros=ros).find(type)
    return found and [(each.name, each.type) for each in found.fields]


@pytest.mark.parametrize("spelled", ["my_msgs/Wear", "my_msgs/msg/Wear"])
def test_an_installed_type_is_known_by_its_fields_and_those_in_it(install, spelled):
    install("my_msgs", Wear="Part[] parts\nbool worn", Part="float64 hours")
    found = DefinitionRegistry(ros=2).find(spelled)
    assert [each.name for each in found.fields] == ["parts", "worn"]
    assert [each.name for each in found.nested["my_msgs/Part"].fields] == ["hours"]


def test_only_ros_2_has_installed_types(install):
    install("my_msgs", Wear="bool worn")
    assert fields("my_msgs/Wear", ros=1) is None


def test_of_an_action_the_goal_is_known(install):
    install("my_msgs", "action", Dig="float64 depth\n---\nbool done\n---\nint8 percent")
    found = DefinitionRegistry(ros=2).find("my_msgs/action/Dig")
    assert (found.type, [each.name for each in found.fields]) == ("my_msgs/Dig_Goal", ["depth"])


def test_the_plan_counts_before_what_is_installed_and_that_before_what_is_standard(install):
    install("std_msgs", String="float64 data")
    assert fields("std_msgs/String") == [("data", "float64")]
    own = MessageDefinition(type="std_msgs/msg/String", definition="int8 data")
    assert fields("std_msgs/String", own) == [("data", "int8")]


def test_a_package_that_is_not_installed_may_be_standard(install):
    install("my_msgs", Wear="bool worn")
    assert fields("std_msgs/Bool") == [("data", "bool")]
    assert fields("my_msgs/Tear") is None


def test_a_plan_s_own_type_may_hold_an_installed_one(install):
    install("my_msgs", Part="float64 hours")
    own = MessageDefinition(type="plan_msgs/Whole", definition="my_msgs/Part part")
    assert fields("plan_msgs/Whole", own) == [("part", "my_msgs/Part")]


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("wstring name", "wstring is no type that RTron reads"),
        ("Wear wear", "contains itself"),
        ("Tear tear", "my_msgs/msg/Tear is not installed here"),
        ("#" * (1 << 16) + "\nint8 x", "is longer than"),
    ],
)
def test_an_installed_type_that_cannot_be_used_says_so(install, text, said):
    install("my_msgs", Wear=text)
    with pytest.raises(InputError, match=said) as error:
        DefinitionRegistry(ros=2).find("my_msgs/Wear")
    assert "my_msgs/msg/Wear as it is installed here" in str(error.value)


def test_the_guard_does_without_a_type_that_cannot_be_used(install):
    install("my_msgs", Wear="wstring name")
    read = stamp_of(TypeInfo("my_msgs/Wear", "0" * 32), Encoding.CDR)
    assert read(b"") == 0
