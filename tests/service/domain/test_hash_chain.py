import json
import subprocess
import sys
from dataclasses import replace

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from rtron.service.domain.hash_chain import (
    GENESIS,
    Head,
    Link,
    Witness,
    canonical_json,
    check_chain,
    next_head,
)

texts = st.text(max_size=5)
values = st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False, width=64) | texts
contents = st.dictionaries(
    texts, values.filter(lambda value: value not in (float("inf"), float("-inf"))), max_size=3
)
logs = st.lists(contents, min_size=2, max_size=12)


def chain_of(log, name="robot:car1"):
    """Return the links of a log, and its head."""
    links, head = [], GENESIS
    for content in log:
        head = next_head(name, head, content)
        links.append(Link(head.number, head.hash, content))
    return links, head


def faults_of(links, end=None, witnesses=(), begin=GENESIS, name="robot:car1"):
    return check_chain(name, begin, links, end, witnesses).faults


def witness(head):
    return Witness(head, "of a file")


def test_the_hash_is_sha256_over_the_hash_before_and_the_entry():
    text = '["' + "0" * 64 + '","c",1,{"a":1.5,"b":"\\u00e4"}]'
    expected = subprocess.run(
        ["sha256sum"], input=text.encode(), capture_output=True, check=True
    ).stdout.split()[0]
    assert next_head("c", GENESIS, {"b": "ä", "a": 1.5}) == Head(1, expected.decode())


@given(contents)
def test_what_json_has_carried_has_the_same_canonical_text(content):
    assert canonical_json(json.loads(json.dumps(content))) == canonical_json(content)


def test_what_json_does_not_have_has_no_canonical_text():
    with pytest.raises(ValueError, match="not JSON compliant"):
        canonical_json({"a": float("nan")})


@given(st.lists(contents, max_size=12))
def test_a_whole_chain_has_no_faults(log):
    links, head = chain_of(log)
    report = check_chain("robot:car1", GENESIS, links, head, [witness(head)])
    assert (report.faults, report.end, report.compared) == ([], head, 1)


@given(logs, st.data())
def test_any_change_of_an_entry_is_found_where_it_is(log, data):
    links, head = chain_of(log)
    at = data.draw(st.integers(0, len(links) - 1))
    other = data.draw(contents)
    assume(canonical_json(other) != canonical_json(log[at]))
    links[at] = replace(links[at], content=other)
    assert faults_of(links, head) == [f"entry {at + 1} was changed, or is not where it was"]


@given(logs, st.data())
def test_any_change_of_a_hash_is_found(log, data):
    links, head = chain_of(log)
    at = data.draw(st.integers(0, len(links) - 1))
    place = data.draw(st.integers(0, 63))
    digit = data.draw(st.sampled_from("0123456789abcdef"))
    changed = links[at].hash[:place] + digit + links[at].hash[place + 1 :]
    assume(changed != links[at].hash)
    links[at] = replace(links[at], hash=changed)
    assert faults_of(links, head)


@given(logs, st.data())
def test_any_deletion_is_found_and_named(log, data):
    links, head = chain_of(log)
    first = data.draw(st.integers(0, len(links) - 1))
    last = data.draw(st.integers(first, len(links) - 1))
    del links[first : last + 1]
    (fault, *others) = faults_of(links, head)
    names = f"entry {first + 1} is" if first == last else f"entries {first + 1} to {last + 1} are"
    assert fault == f"{names} missing"
    assert others == []


@given(logs, st.data())
def test_an_entry_whose_row_is_gone_is_named(log, data):
    links, head = chain_of(log)
    at = data.draw(st.integers(0, len(links) - 1))
    links[at] = replace(links[at], content=None)
    assert faults_of(links, head) == [f"entry {at + 1} is gone, only its hash is left"]


@given(logs, st.data())
def test_any_swap_of_entries_is_found(log, data):
    links, head = chain_of(log)
    a = data.draw(st.integers(0, len(links) - 2))
    b = data.draw(st.integers(a + 1, len(links) - 1))
    assume(canonical_json(log[a]) != canonical_json(log[b]))
    links[a], links[b] = (replace(links[a], content=log[b]), replace(links[b], content=log[a]))
    assert [fault.split()[1] for fault in faults_of(links, head)] == [str(a + 1), str(b + 1)]


@given(logs, st.data())
def test_entries_with_their_hashes_in_another_order_are_found(log, data):
    links, head = chain_of(log)
    shuffled = data.draw(st.permutations(links))
    assume(shuffled != links)
    renumbered = [replace(link, number=at + 1) for at, link in enumerate(shuffled)]
    assert faults_of(shuffled, head)
    assert faults_of(renumbered, head)


@given(logs, contents, st.data())
def test_an_entry_that_is_put_in_is_found(log, content, data):
    links, head = chain_of(log)
    at = data.draw(st.integers(1, len(links)))
    forged = next_head("robot:car1", Head(at - 1, GENESIS.hash), content)
    links.insert(at, Link(at, forged.hash, content))
    assert faults_of(links, head)


@given(logs, st.data())
def test_a_cut_off_end_is_found_by_the_head(log, data):
    links, head = chain_of(log)
    kept = data.draw(st.integers(0, len(links) - 1))
    assert faults_of(links[:kept], head)


@given(logs, st.data())
def test_a_cut_off_end_is_found_by_a_witness_although_the_head_was_rewritten(log, data):
    links, head = chain_of(log)
    kept = data.draw(st.integers(0, len(links) - 1))
    rest, rewritten = chain_of(log[:kept])
    assert faults_of(rest, rewritten) == []
    (fault,) = faults_of(rest, rewritten, [witness(head)])
    assert "cut off the end, but in the head of a file" in fault


@given(logs, contents, st.data())
def test_a_chain_that_was_rewritten_whole_is_found_by_any_witness_behind_the_change(
    log, other, data
):
    links, _ = chain_of(log)
    at = data.draw(st.integers(0, len(links) - 1))
    assume(canonical_json(other) != canonical_json(log[at]))
    forged, forged_head = chain_of([*log[:at], other, *log[at + 1 :]])
    assert faults_of(forged, forged_head) == []
    seen = data.draw(st.integers(at, len(links) - 1))
    (fault,) = faults_of(forged, forged_head, [witness(Head(seen + 1, links[seen].hash))])
    assert "was another" in fault


@given(logs, st.data())
def test_a_chain_may_begin_behind_an_anchor_and_nowhere_else(log, data):
    links, head = chain_of(log)
    cut = data.draw(st.integers(1, len(links) - 1))
    anchor = Head(links[cut - 1].number, links[cut - 1].hash)
    assert faults_of(links[cut:], head, begin=anchor) == []
    assert faults_of(links[cut + 1 :], head, begin=anchor)
    assert faults_of(links[cut:], head)
    assert faults_of(links[cut:], head, begin=Head(anchor.number, "f" * 64))


def test_a_witness_before_the_anchor_is_not_compared_and_that_is_told():
    links, head = chain_of([{"n": n} for n in range(5)])
    old, newer = (witness(Head(links[at].number, links[at].hash)) for at in (0, 2))
    begin = Head(links[1].number, links[1].hash)
    report = check_chain("robot:car1", begin, links[2:], head, [old, newer])
    assert (report.witnesses, report.compared, report.faults) == (2, 1, [])


def test_the_entries_of_a_chain_are_those_of_no_other():
    links, head = chain_of([{"n": 1}], name="robot:car1")
    assert faults_of(links, head, name="robot:car2")


def test_many_faults_are_counted_and_the_first_ones_told():
    links, head = chain_of([{"n": n} for n in range(100)])
    changed = [replace(link, content={"n": -1}) for link in links]
    report = check_chain("robot:car1", GENESIS, changed, head, [])
    assert (len(report.faults), report.more_faults) == (20, 80)


def test_the_canonical_text_does_not_depend_on_the_process():
    program = (
        "from rtron.service.domain.hash_chain import *;"
        "print(next_head('c', GENESIS, {k: 1 for k in {'b','a','c'}}).hash)"
    )
    found = {
        subprocess.run(
            [sys.executable, "-c", program],
            env={"PYTHONHASHSEED": seed, "PYTHONPATH": ":".join(sys.path)},
            capture_output=True,
            text=True,
            check=True,
        ).stdout
        for seed in ("1", "2")
    }
    assert len(found) == 1
