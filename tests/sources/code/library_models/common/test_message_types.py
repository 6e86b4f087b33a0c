"""Message types as C++ names them."""

import pytest

from rtron.sources.code.ir import TypeRef
from rtron.sources.code.library_models.common.message_types import cpp_message_type


@pytest.mark.parametrize(
    ("written", "expected"),
    [
        ("std_msgs::String", "std_msgs/String"),
        ("std_msgs::String::ConstPtr", "std_msgs/String"),
        ("std_msgs::StringConstPtr", "std_msgs/String"),
        ("std_msgs::msg::String", "std_msgs/msg/String"),
        ("std_msgs::msg::String::SharedPtr", "std_msgs/msg/String"),
        ("std_msgs::msg::String::ConstSharedPtr", "std_msgs/msg/String"),
        ("std::string", ""),
        ("String", ""),
    ],
)
def test_a_type_is_a_message_of_a_package(written, expected):
    assert cpp_message_type(TypeRef(written)) == expected


@pytest.mark.parametrize(
    "pointer", ["Ptr", "ConstPtr", "SharedPtr", "ConstSharedPtr", "UniquePtr", "ConstUniquePtr"]
)
def test_a_pointer_to_a_message_without_its_package_is_none(pointer):
    """`using namespace` leaves the package out: Mode is none in `Mode::SharedPtr`."""
    assert cpp_message_type(TypeRef(f"Mode::{pointer}")) == ""
