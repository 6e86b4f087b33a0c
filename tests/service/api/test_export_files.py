import csv
import io
import json

import pytest

from rtron.service.api.routes.exports import csv_lines, json_array


def cell(value, name="reason"):
    """Return a value as a CSV reader finds it."""
    text = "".join(csv_lines([{name: value}], [name]))
    (_, (found,)) = csv.reader(io.StringIO(text))
    return found


@pytest.mark.parametrize(
    ("value", "shown"),
    [
        ("=1+1", "'=1+1"),
        ("+1", "'+1"),
        ("-2", "'-2"),
        ("@SUM(A1)", "'@SUM(A1)"),
        ("  =1+1", "  '=1+1"),
        ("\uff1d1+1", "'\uff1d1+1"),
        ("\t=1", "\\t=1"),
        ("a;=cmd|' /C calc'!A0", "a;'=cmd|' /C calc'!A0"),
        ('a";=1', "a\";'=1"),
        ("a\n=1", "a\\n=1"),
        ("fine: 3 - 2 = 1", "fine: 3 - 2 = 1"),
        ("/cmd_vel", "/cmd_vel"),
        ("\u202egnp.exe", "\\u202egnp.exe"),
    ],
)
def test_no_cell_is_a_formula_or_hides_anything(value, shown):
    assert cell(value) == shown


@pytest.mark.parametrize(
    ("name", "value", "shown"),
    [
        ("x", -2.5, "-2.5"),
        ("x", None, ""),
        ("x", True, "true"),
        ("x", {"a": ["=1"]}, '{"a": ["\'=1"]}'),
        ("at", 1_800_000_000_123_000_000, "2027-01-15T08:00:00.123Z"),
    ],
)
def test_other_values_are_readable(name, value, shown):
    assert cell(value, name) == shown


def test_a_spreadsheet_reads_it_as_utf_8():
    text = "".join(csv_lines([], ["name"]))
    assert text.encode().startswith(b"\xef\xbb\xbf")


@pytest.mark.parametrize("rows", [[], [{"a": 1}], [{"a": "=1"}, {"a": None}]])
def test_json_is_what_it_was(rows):
    assert json.loads("".join(json_array(rows, ["a"]))) == rows
