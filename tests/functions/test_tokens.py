"""Names and sentences become words."""

import pytest

from rtron.functions.text import name_tokens, split_sentences, stem, tokenize


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("teb_local_planner", "teb local planner"),
        ("hls-lfcd.driver", "hls lfcd driver"),
        ("RosAria", "ros aria"),
        ("pointGrayDriver", "point gray driver"),
        ("laserToCloud", "laser to cloud"),
        ("turtlebot3", "turtlebot 3"),
        ("hokuyo3d", "hokuyo 3d"),
        ("tf2_ros", "tf2 ros"),
        ("um7", "um7"),
        ("libfreenect", "freenect"),
        ("library", "library"),
        ("lib", "lib"),
        ("", ""),
        ("___", ""),
    ],
)
def test_a_name_is_parted(name, words):
    assert " ".join(name_tokens(name).words) == words


def test_a_name_is_bounded():
    assert len("".join(name_tokens("ab_" * 10_000).words)) <= 200
    assert len(name_tokens("a" * 150).words[0]) == 40


@pytest.mark.parametrize(
    ("one", "other"),
    [
        ("visualize", "visualization"),
        ("drivers", "driver"),
        ("simulated", "simulation"),
        ("libraries", "library"),
    ],
)
def test_variants_have_one_stem(one, other):
    assert stem(one) == stem(other)


def test_tokens_are_in_lower_case_with_their_stems():
    found = tokenize(["Laser", "Filters"])
    assert found.words == ("laser", "filters")
    assert found.stems == ("laser", "filter")


def test_a_text_is_parted_into_sentences():
    text = "Drives a robot. Plans paths!\n- one item\n- another_item\n\nA paragraph\ngoes on."
    assert [" ".join(found.words) for found in split_sentences(text, 10)] == [
        "drives a robot",
        "plans paths",
        "one item",
        "another item",
        "a paragraph goes on",
    ]


def test_a_version_and_an_address_do_not_end_a_sentence():
    assert len(list(split_sentences("Works with 1.2 of example.org today", 10))) == 1


def test_a_sentence_keeps_camel_humps_whole():
    assert next(split_sentences("TurtleBot3 with MoveIt", 1)).words == (
        "turtlebot",
        "3",
        "with",
        "moveit",
    )


def test_sentences_are_bounded():
    assert len(list(split_sentences("A word. " * 100, 7))) == 7
    assert len(next(split_sentences("word " * 500, 1)).words) == 60
