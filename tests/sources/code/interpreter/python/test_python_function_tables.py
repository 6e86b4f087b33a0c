"""Tables of functions, of which a message picks one: each may be called."""

import pytest
from ros1_runs import cpp, names, python

COUNT = 40
METHODS = "\n".join(f"    def do_{n}(self, word): P('p{n}')" for n in range(COUNT))
TABLE = ", ".join(f"'{n}': self.do_{n}" for n in range(COUNT))
SERVER = f"""
class Server:
    def __init__(self):
        self.table = {{{TABLE}}}
    def handle(self, message):
        command, word = message.split(':')
        if command in self.table:
            return self.table[command](word)
{METHODS}
"""
FUNCTIONS = "\n".join(
    f'void do_{n}() {{ ros::NodeHandle().advertise<std_msgs::Bool>("p{n}", 1); }}'
    for n in range(COUNT)
)
CPP_TABLE = ", ".join(f'{{"{n}", &do_{n}}}' for n in range(COUNT))


def test_every_function_of_a_long_table_may_be_called():
    found = python(f"{SERVER}\nServer().handle(input())")
    assert names(found) == [f"p{n}" for n in range(COUNT)]


@pytest.mark.parametrize("key", ["argv[1]", "std::string(argv[1])"])
def test_every_function_of_a_long_table_of_cpp_may_be_called(key):
    body = f"std::map<std::string, void (*)()> table{{{CPP_TABLE}}};\n  table[{key}]();"
    assert set(names(cpp(body, FUNCTIONS))) == {f"p{n}" for n in range(COUNT)}


def test_a_table_that_is_far_too_long_is_noted():
    methods = "\n".join(f"    def far_{n}(self, word): P('p{n}')" for n in range(200))
    table = ", ".join(f"'{n}': self.far_{n}" for n in range(200))
    server = SERVER.replace(METHODS, methods).replace(TABLE, table)
    found = python(f"{server}\nServer().handle(input())")
    assert names(found) == []
    assert [note.what for note in found.unresolved] == ["P() and 200 more"]
