"""Patterns over words."""

import pytest

from rtron.errors import InputError
from rtron.functions.patterns.parser import parse_pattern
from rtron.functions.patterns.syntax_tree import PatternIndex, matches_at
from rtron.functions.text import tokenize

LISTS = {"maker": parse_pattern("velodyne | point grey", {})}


def found(pattern, text):
    index = PatternIndex([(parse_pattern(pattern, LISTS), pattern)])
    words = tokenize(text.split())
    return [" ".join(words.words[match.start : match.end]) for match in index.find(words)]


@pytest.mark.parametrize(
    ("pattern", "text", "match"),
    [
        ("laser scanner", "two laser scanners here", "laser scanners"),
        ("=scan", "a scan", "scan"),
        ("*lidar", "an rplidar", "rplidar"),
        ("rqt*", "the rqtplot", "rqtplot"),
        ("(camera | lidar) driver", "lidar driver", "lidar driver"),
        ("(point cloud | scan) filter", "point cloud filters", "point cloud filters"),
        ("image proc? node", "image node", "image node"),
        ("image proc? node", "image proc node", "image proc node"),
        ("driver ..2 camera", "driver camera", "driver camera"),
        ("driver ..2 camera", "driver for a camera", "driver for a camera"),
        ("^ driver", "driver of", "driver"),
        ("driver $", "camera driver", "driver"),
        ("camera !(simulated | fake)", "camera real", "camera"),
        ("camera !(simulated | fake)", "camera", "camera"),
        ("@maker driver", "point grey driver", "point grey driver"),
        ("(^ arm | gripper)", "a gripper", "gripper"),
    ],
)
def test_a_pattern_matches(pattern, text, match):
    assert found(pattern, text) == [match]


@pytest.mark.parametrize(
    ("pattern", "text"),
    [
        ("laser scanner", "laser"),
        ("laser scanner", "scanner laser"),
        ("=scan", "scans"),
        ("*lidar", "lidars"),
        ("rqt*", "arqt"),
        ("a *lidar", "a lidars"),
        ("(camera | lidar) driver", "radar driver"),
        ("driver ..2 camera", "driver for a small camera"),
        ("^ driver", "camera driver"),
        ("driver $", "driver camera"),
        ("camera !(simulated | fake)", "camera faked"),
        ("@maker driver", "point driver"),
        ("(^ arm | gripper)", "an arm"),
        ("camera", ""),
    ],
)
def test_a_pattern_does_not_match(pattern, text):
    assert found(pattern, text) == []


def test_every_place_is_found_each_with_its_shortest_match():
    assert found("(a | b) ..1 c", "a b c c") == ["a b c", "b c"]


@pytest.mark.parametrize(
    ("pattern", "message"),
    [
        ("", "a word is missing"),
        ("a |", "a word is missing"),
        ("(a", r"`\)` is missing"),
        ("a)", "not expected"),
        ("@nobody", "no list @nobody"),
        ("a & b", "cannot read '& b'"),
        ("Upper", "cannot read"),
        ("a ?? b", "not expected"),
        ("a !", "not expected"),
        ("(" * 20 + "a" + ")" * 20, "too deep"),
    ],
)
def test_what_is_no_pattern_is_told(pattern, message):
    with pytest.raises(InputError, match=message):
        parse_pattern(pattern, {})


@pytest.mark.parametrize(
    "pattern", ["..2 camera", "camera?", "!camera driver", "^ ..1 camera", "^"]
)
def test_a_pattern_that_begins_with_no_word_is_refused(pattern):
    with pytest.raises(InputError, match="begins with a word"):
        PatternIndex([(parse_pattern(pattern, {}), 1)])


def test_a_gap_stops_at_the_end():
    assert not matches_at(parse_pattern("a ..9 b", {}), tokenize(["a", "c"]), 0)


def test_many_gaps_in_a_long_sentence_take_no_time():
    pattern = parse_pattern("a ..9 a ..9 a ..9 b", {})
    assert not matches_at(pattern, tokenize(["a"] * 60), 0)
