"""The memory that the guard and its supervisor share."""

import os
import struct

import pytest

from rtron.guard.supervision.shared_memory import (
    GuardMemory,
    LastMessage,
    StatusWord,
    decode_last_message,
    decode_type_info,
    encode_last_message,
    encode_type_info,
)
from rtron.guard.transport.common.protocol import TypeInfo


@pytest.fixture
def page():
    made = GuardMemory.create(2)
    yield made
    made.close()


def supervisor_page(page):
    return GuardMemory(os.dup(page.descriptor), 2)


def test_what_one_side_writes_the_other_reads(page):
    other = supervisor_page(page)
    assert other[StatusWord.GUARD_BEAT] == 0
    assert other.last_messages[1].read() == (0, b"")
    page[StatusWord.GUARD_BEAT] = (1 << 64) - 1
    page.last_messages[1].write(b"second")
    assert other[StatusWord.GUARD_BEAT] == (1 << 64) - 1
    assert other.last_messages[0].read() == (0, b"")
    assert other.last_messages[1].read() == (1, b"second")
    other.close()


def test_the_newest_document_counts_whatever_its_length(page):
    cell = page.failure_report
    for number, document in enumerate((b"long" * 10, b"", b"x", b"yy"), start=1):
        assert cell.write(document)
        assert cell.read() == (number, document)
        assert cell.write_count() == number


def test_a_document_that_is_too_long_takes_the_place_of_the_one_before(page):
    assert page.failure_report.write(b"x" * (1 << 12))
    assert not page.failure_report.write(b"x" * ((1 << 12) + 1))
    assert page.failure_report.read() == (2, b"")


def test_a_writer_that_dies_in_the_middle_leaves_the_document_before(page):
    cell = page.failure_report
    cell.write(b"first")
    cell.write(b"second")
    older = cell._halves[1]
    size = struct.calcsize("=QII")
    cell._memory[older + size : older + size + 3] = b"thi"
    assert cell.read() == (2, b"second")
    struct.pack_into("=QII", cell._memory, older, 3, 5, 0)
    assert cell.read() == (2, b"second")


def test_a_head_that_promises_more_than_there_is_gives_nothing(page):
    cell = page.failure_report
    struct.pack_into("=QII", cell._memory, cell._halves[1], 7, 1 << 31, 0)
    assert cell.read() == (0, b"")


def test_another_writer_goes_on_where_the_first_stopped(page):
    page.handover_state.write(b"one")
    other = supervisor_page(page)
    other.handover_state.write(b"two")
    assert page.handover_state.read() == (2, b"two")
    other.close()


def test_types_and_messages_survive():
    info = TypeInfo("geometry_msgs/Twist", "9f19", "float64 é\n")
    assert decode_type_info(encode_type_info(info)) == info
    assert decode_type_info(b"") is None
    assert decode_last_message(encode_last_message(1, 2, b"abc")) == LastMessage(1, 2, b"abc")
    assert decode_last_message(b"") == LastMessage(0, 0, b"")


def test_what_is_too_long_is_left_out():
    long = TypeInfo("a/B", "9f19", "x" * 40_000)
    assert decode_type_info(encode_type_info(long)) == TypeInfo("a/B", "9f19", "")
    assert decode_last_message(encode_last_message(1, 2, b"x" * 3000)) == LastMessage(1, 2, b"")
