"""The memory that the guard and its supervisor share."""

import os
import struct

import pytest

from rtron.guard.supervision.last_message import Said, info_bytes, info_of, said_of
from rtron.guard.supervision.shared_memory import Field, Page
from rtron.guard.transport.common.protocol import TypeInfo


@pytest.fixture
def page():
    made = Page.new(2)
    yield made
    made.close()


def other_side(page):
    return Page(os.dup(page.descriptor), 2)


def test_what_one_side_writes_the_other_reads(page):
    other = other_side(page)
    assert other[Field.GUARD_BEAT] == 0
    assert other.said[1].read() == (0, b"")
    page[Field.GUARD_BEAT] = (1 << 64) - 1
    page.said[1].write(b"second")
    assert other[Field.GUARD_BEAT] == (1 << 64) - 1
    assert other.said[0].read() == (0, b"")
    assert other.said[1].read() == (1, b"second")
    other.close()


def test_the_newest_document_counts_whatever_its_length(page):
    cell = page.news
    for number, document in enumerate((b"long" * 10, b"", b"x", b"yy"), start=1):
        assert cell.write(document)
        assert cell.read() == (number, document)
        assert cell.count() == number


def test_a_document_that_is_too_long_takes_the_place_of_the_one_before(page):
    assert page.news.write(b"x" * (1 << 12))
    assert not page.news.write(b"x" * ((1 << 12) + 1))
    assert page.news.read() == (2, b"")


def test_a_writer_that_dies_in_the_middle_leaves_the_document_before(page):
    cell = page.news
    cell.write(b"first")
    cell.write(b"second")
    older = cell._halves[1]
    size = struct.calcsize("=QII")
    cell._memory[older + size : older + size + 3] = b"thi"
    assert cell.read() == (2, b"second")
    struct.pack_into("=QII", cell._memory, older, 3, 5, 0)
    assert cell.read() == (2, b"second")


def test_a_head_that_promises_more_than_there_is_gives_nothing(page):
    cell = page.news
    struct.pack_into("=QII", cell._memory, cell._halves[1], 7, 1 << 31, 0)
    assert cell.read() == (0, b"")


def test_another_writer_goes_on_where_the_first_stopped(page):
    page.will.write(b"one")
    other = other_side(page)
    other.will.write(b"two")
    assert page.will.read() == (2, b"two")
    other.close()


def test_types_and_messages_survive():
    info = TypeInfo("geometry_msgs/Twist", "9f19", "float64 é\n")
    assert info_of(info_bytes(info)) == info
    assert info_of(b"") is None
    assert said_of(Said(1, 2, b"abc").bytes()) == Said(1, 2, b"abc")
    assert said_of(b"") == Said(0, 0, b"")


def test_what_is_too_long_is_left_out():
    long = TypeInfo("a/B", "9f19", "x" * 40_000)
    assert info_of(info_bytes(long)) == TypeInfo("a/B", "9f19", "")
    assert said_of(Said(1, 2, b"x" * 3000).bytes()) == Said(1, 2, b"")
