"""Compares two descriptions element by element, numbers as floats."""

import json
import math
import os
import subprocess
import sys
from pathlib import Path
from xml.dom import minidom


def run_real_xacro(jobs, packages=None, environ=None):
    """Return, for each (file, arguments), the real xacro's XML, or None and what it says."""
    work = {"packages": {k: str(v) for k, v in (packages or {}).items()}, "jobs": jobs}
    ran = subprocess.run(
        [sys.executable, str(Path(__file__).with_name("real_xacro.py"))],
        input=json.dumps(work),
        capture_output=True,
        text=True,
        timeout=110,
        check=True,
        env={**os.environ, **(environ or {})},
    )
    return [json.loads(line) for line in ran.stdout.splitlines()]


def xml_differences(one, other):
    """Return where two XML texts differ, as lines for people; none if they are equal."""
    found = []
    roots = [minidom.parseString(text).documentElement for text in (one, other)]
    _compare(*roots, found)
    return found


def _compare(one, other, fake_study):
    location = f"<{one.tagName} {one.getAttribute('name')}>"
    if one.tagName != other.tagName:
        fake_study.append(f"{location} is <{other.tagName}>")
        return
    ours, theirs = _attributes(one), _attributes(other)
    if ours.keys() != theirs.keys():
        fake_study.append(f"{location} attributes {sorted(ours)} {sorted(theirs)}")
    for name in ours.keys() & theirs.keys():
        if not _same_text(ours[name], theirs[name]):
            fake_study.append(f"{location} {name}: {ours[name]!r} {theirs[name]!r}")
    if not _same_text(_text(one), _text(other)):
        fake_study.append(f"{location} text {_text(one)!r} {_text(other)!r}")
    inner, others = _elements(one), _elements(other)
    if [e.tagName for e in inner] != [e.tagName for e in others]:
        fake_study.append(
            f"{location} holds {[e.tagName for e in inner]} {[e.tagName for e in others]}"
        )
        return
    for pair in zip(inner, others, strict=True):
        _compare(*pair, fake_study)


def _attributes(element):
    return {k: v for k, v in element.attributes.items() if not k.startswith("xmlns")}


def _elements(element):
    return [child for child in element.childNodes if child.nodeType == child.ELEMENT_NODE]


def _text(element):
    kinds = (element.TEXT_NODE, element.CDATA_SECTION_NODE)
    return "".join(child.data for child in element.childNodes if child.nodeType in kinds)


def _same_text(one, other):
    ours, theirs = one.split(), other.split()
    return len(ours) == len(theirs) and all(map(_same_word, ours, theirs))


def _same_word(one, other):
    try:
        return one == other or math.isclose(float(one), float(other), rel_tol=1e-12, abs_tol=1e-15)
    except ValueError:
        return False
