"""What code that is not here gets by its address may hold anything afterwards."""

import pytest
from ros1_runs import cpp, names

ADVERTISE = 'nh.advertise<std_msgs::Bool>("found", 1);'
WRITTEN = {
    "uint8_t data[8] = {0}; ::read(file, data, 8); if (data[0] != 5) return 1;",
    "uint8_t data[8] = {0}; read_into(data); if (data[0] != 5) return 1;",
    "int data[2] = {1, 2}; read(&data[1]); if (data[1] != 5) return 1;",
    'char data[4] = {0}; read(data); std::string kind(data, 4); if (kind != "TRAX") return 1;',
    "int count = 0; device.read(&count); if (count != 5) return 1;",
    "float count = 0; memcpy(reinterpret_cast<char*>(&count), bytes, 4); if (count < 5) return 1;",
    "float count = 0; memcpy((char*) &count, bytes, 4); if (count < 5) return 1;",
    "Status status; ioctl(file, GET, &status); if (!status.ready) return 1;",
    "Status* status = nullptr; open_status(&status); if (!status) return 1;",
    "Status status; only_declared(&status); if (!status.ready) return 1;",
}
TOP = """
struct Status { bool ready = false; };
void read_into(uint8_t* target) { memcpy(target, bytes, 4); }
void only_declared(Status* status);
"""


@pytest.mark.parametrize("body", sorted(WRITTEN))
def test_what_an_unknown_function_gets_by_its_address_may_be_anything(body):
    assert names(cpp(body + ADVERTISE, TOP)) == ["found"]


def test_what_it_gets_by_value_stays():
    body = "for (int n : {1, 2}) { show(n); nh.advertise<std_msgs::Bool>(std::to_string(n), 1); }"
    assert names(cpp(body)) == ["1", "2"]


def test_a_text_that_is_written_may_stay_what_it_is():
    body = 'std::string name = "a"; configure(&name); nh.advertise<std_msgs::Bool>(name, 1);'
    assert names(cpp(body)) == ["a", "{name}"]


def test_a_program_that_ends_before_all_its_endpoints_is_noted():
    """Logging writes to nothing, so `n` is 0."""
    found = cpp('int n = 0; ROS_INFO("%p", &n); if (n == 0) return 1;' + ADVERTISE)
    assert names(found) == []
    assert [(note.what, note.why) for note in found.unresolved] == [
        ("main()", "makes endpoints, but ends before the first of them by what is known here")
    ]
    assert found.unresolved[0].evidence[0].line == 4
