"""Links between pages lead to files and headings; messages that a page quotes are in the code."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PAGES = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").rglob("*.md"))]
TROUBLES = ROOT / "docs" / "troubleshooting.md"
BETWEEN_PROCESSES = {"rtron.visit/1"}
"""Formats of files that do not outlive the command."""


def anchors(page):
    """Return the addresses of a page's headings, as GitHub makes them."""
    headings = re.findall(r"^#+ (.+)$", page.read_text("utf-8"), re.MULTILINE)
    words = (re.sub(r"[^\w\- ]", "", heading.lower()) for heading in headings)
    return {each.replace(" ", "-") for each in words}


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.relative_to(ROOT).as_posix())
def test_links_lead_somewhere(page):
    text = re.sub(r"```.*?```", "", page.read_text("utf-8"), flags=re.DOTALL)
    for link in re.findall(r"\]\(([^)\s]+)\)", text):
        if not link.startswith(("http", "mailto:")):
            name, _, anchor = link.partition("#")
            target = (page.parent / name) if name else page
            assert target.exists(), link
            assert not anchor or anchor in anchors(target), link


def test_the_messages_of_the_troubleshooting_page_are_rtrons():
    code = "".join(path.read_text("utf-8") for path in (ROOT / "src").rglob("*.py"))
    code += "".join(path.read_text("utf-8") for path in (ROOT / "src").rglob("*.py.in"))
    quoted = re.findall(r'"([^"|]{9,})"', TROUBLES.read_text("utf-8"))
    messages = [each.removesuffix("…").strip() for each in quoted if not each.startswith("rtron[")]
    assert len(messages) > 10
    plain = re.sub(r"\{[^}]*\}|%s", "", code)
    assert [each for each in messages if each not in code and each not in plain] == []


def test_the_page_on_upgrading_names_every_format():
    code = "".join(path.read_text("utf-8") for path in (ROOT / "src").rglob("*.py"))
    formats = set(re.findall(r'"(rtron\.[a-z_]+/\d+)"', code)) - BETWEEN_PROCESSES
    page = (ROOT / "docs" / "upgrading.md").read_text("utf-8")
    assert {each for each in formats if f"`{each}`" not in page} == set()
