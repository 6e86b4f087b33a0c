"""What a node reads from its own Lua file; which parameters and plugins a model asks for."""

import pytest
from model_cases import ros2_node_site, site

from rtron.sources.models.common.functions import model_functions
from rtron.sources.models.common.model_scope import node_scope
from rtron.sources.models.common.node_files import read_lua_setting
from rtron.sources.models.common.values import Placeholder, placeholder


@pytest.fixture
def settings(tmp_path):
    def read(text, **others):
        for name, content in {"main": text, **others}.items():
            (tmp_path / f"{name}.lua").write_text(content, encoding="utf-8")
        return lambda key: read_lua_setting(str(tmp_path), "main.lua", key)

    return read


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("a = 1", 1),
        ("a=-0.5,", -0.5),
        ("x = { a = 'two words', }", "two words"),
        ('options.deep.a = "odom"', "odom"),
        ("x={a=true}", True),
        ("a = false -- a = true", False),
        ("a = 1 --[[ a = 2\na = 3 ]] ", 1),
        ("a = 1 --[[ a = 2", 1),
        ("a = 1\na = 2", 2),
        ('a = "', ""),
    ],
)
def test_the_last_value_that_a_name_gets_counts(settings, text, value):
    assert settings(text)("a") == value


@pytest.mark.parametrize("value", ["math.rad(3)", "other", "nan", "inf", "1e999", "9" * 5000, "{"])
def test_what_is_no_plain_number_or_text_is_a_hole(settings, value):
    assert isinstance(settings(f"a = {value}")("a"), Placeholder)


@pytest.mark.parametrize("text", ["", "if a == 1 then", "\x00", "=" * 1000, "a " * 100_000])
def test_what_assigns_nothing_has_no_values(settings, text):
    assert settings(text)("a") is None


def test_a_file_includes_what_is_beside_it_once(settings):
    found = settings(
        'include "base.lua"\nb = 2\ninclude "../main.lua"\ninclude "none.lua"',
        base='a, b = 1, 1 a = 7 include "main.lua" c = 3',
    )
    assert [found(key) for key in "abcd"] == [7, 2, 3, None]


def test_a_long_chain_of_files_ends(settings):
    chain = {f"f{n}": f'b = {n}\ninclude "f{n + 1}.lua"' for n in range(2000)}
    assert settings('a = 1\ninclude "f0.lua"', **chain)("a") == 1


def test_a_file_that_is_too_large_or_missing_has_no_values(settings, tmp_path):
    assert settings("a = 1\n" + " " * 2_000_000)("a") is None
    for folder, name in [(str(tmp_path), "other.lua"), ("", "main.lua"), (placeholder("x"), "a")]:
        assert read_lua_setting(folder, name, "a", 5) == 5


FUNCTIONS = model_functions(node_scope(site()))


@pytest.mark.parametrize(
    ("name", "patterns", "found"),
    [
        ("sys_status", ["sys_*"], True),
        ("sys_status", ["SYS_*"], True),
        ("imu", ["*"], True),
        ("imu", [], False),
        ("imu", ["im", "gps"], False),
        ("imu", [3, None], False),
    ],
)
def test_a_name_matches_one_of_the_patterns(name, patterns, found):
    assert FUNCTIONS["matches"](name, patterns) is found


def test_whether_a_name_matches_unknown_patterns_is_unknown():
    assert isinstance(FUNCTIONS["matches"]("imu", placeholder("patterns")), Placeholder)


def test_the_children_of_nothing_are_the_first_parts_of_all_parameters():
    at = ros2_node_site(settings={"/**": {"walk.type": "topic", "walk.axes": 1, "rate": 5}})
    functions = model_functions(node_scope(at))
    assert functions["children"]("") == ["walk", "rate"]
    assert functions["children"]("walk") == ["type", "axes"]
