"""Key information (paper A.1): names, descriptions and READMEs, as words.

What of a README tells nothing of the function is left out: how to get, build, cite and share it.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import lru_cache
from itertools import islice
from typing import TYPE_CHECKING

import snowballstemmer  # type: ignore[import-untyped]

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

_STEMMER = snowballstemmer.stemmer("english")
_CACHE_SIZE = 2**16
_MAX_WORD_LENGTH = 40


@dataclass(frozen=True, slots=True)
class Tokens:
    """A name or a sentence: its words in lower case, and their stems, which patterns compare."""

    words: tuple[str, ...]
    stems: tuple[str, ...]


_MAX_LENGTH = 200
_CAMEL = re.compile(r"(?<=[a-z0-9])(?=[A-Z][a-z])|(?<=[a-z])(?=[A-Z])")
_LIBRARY = re.compile(r"^lib(?=[a-z0-9]{3})(?!rar)")
_NUMBERED = re.compile(r"([A-Za-z]{4,})(\d\w*)")
_SENTENCE = re.compile(r"(?<=[.!?;:])\s+|\n\s*\n|\n\s*[-*#+]+\s*|\n\d+[.)]\s+")
_RUN = re.compile(r"[^\W_]+")
_MAX_WORDS = 60


def split_sentences(text: str, limit: int) -> Iterator[Tokens]:
    """Yield the first sentences of a text, list items among them, each cut after 60 words."""
    parts = (part for part in _SENTENCE.split(text) if part.strip())
    for part in islice(parts, limit):
        words = [word for run in _RUN.findall(part) for word in split_number(run)]
        if words:
            yield tokenize(words[:_MAX_WORDS])


_MAX_CHARACTERS = 20_000
_MAX_SENTENCES = 30
_CODE = re.compile(r"```.*?(?:```|\Z)|~~~.*?(?:~~~|\Z)|`[^`\n]*`", re.DOTALL)
_MARKUP = re.compile(
    r"!\[[^\]\n]{0,300}\](?:\([^)\n]{0,300}\))?|<[^<>\n]{0,300}>|\]\([^)\n]{0,300}\)|https?://\S+"
)
_NO_LEVEL = 7
_HEADING = re.compile(
    r"^(?:(?P<signs>#{1,6})\s*(?P<title>[^\n]*)"
    r"|(?P<under>[^\n]+)\n(?P<line>[=\-~^])(?P=line){2,}\s*)$",
    re.MULTILINE,
)
_USELESS_HEADING = re.compile(
    r"\b(?:install|build|compil|require|prerequisite|dependenc|licen[cs]e|copyright|status|badge"
    r"|contribut|author|maintainer|contact|credit|acknowledg|support|citation|cit(?:e|ing)\b"
    r"|reference|publication|changelog|release|download|setup|set up|troubleshoot|faq|bug|issue"
    r"|testing|continuous|docker|getting started|quick ?start|known|todo|roadmap|version|branch)",
    re.IGNORECASE,
)
_USELESS_LINE = re.compile(
    r"^[ \t]*(?:\$|sudo\b|apt\b|apt-get\b|git\b|cd\b|mkdir\b|catkin|colcon|rosdep|roslaunch\b"
    r"|rosrun\b|ros2?\s+(?:run|launch)|source\b|pip3?\b|cmake\b|make\b|wget\b|echo\b|export\b"
    r"|copyright\b|licensed\b|\[?build status|travis).*$",
    re.IGNORECASE | re.MULTILINE,
)


def readme_tokens(readme: str) -> Iterator[Tokens]:
    """Yield the first sentences of a README that may tell what it is for."""
    return split_sentences(clean_readme(readme), _MAX_SENTENCES)


def clean_readme(readme: str) -> str:
    """Return a README's beginning (20,000 characters) without code, links and useless parts."""
    text = _MARKUP.sub(" ", _CODE.sub(" ", readme[:_MAX_CHARACTERS]))
    return _USELESS_LINE.sub("", "\n\n".join(_useful_sections(text)))


def _useful_sections(text: str) -> Iterator[str]:
    at, useless = 0, _NO_LEVEL
    for heading in _HEADING.finditer(text):
        if useless == _NO_LEVEL:
            yield text[at : heading.start()]
        at, useless = heading.end(), _useless_level(heading, useless)
        if useless == _NO_LEVEL:
            yield heading["title"] or heading["under"] or ""
    if useless == _NO_LEVEL:
        yield text[at:]


def _useless_level(heading: re.Match[str], parent_level: int) -> int:
    """Return the level of the useless section that a heading is in: those below it are, too."""
    level = len(heading["signs"] or "") or (1 if heading["line"] == "=" else 2)
    if parent_level < level:
        return parent_level
    return (
        level if _USELESS_HEADING.search(heading["title"] or heading["under"] or "") else _NO_LEVEL
    )


_MAX_DESCRIPTION_CHARACTERS = 4000
_MAX_DESCRIPTION_SENTENCES = 12
_NOISE = re.compile(r"<[^<>]{0,200}>|https?://\S+")
_PLACEHOLDER = re.compile(r"(?:the\s+)?[\w-]+\s+(?:meta-?)?package\.?", re.IGNORECASE)


def description_tokens(description: str) -> Iterator[Tokens]:
    """Yield the sentences of a description; none if it is a placeholder (`The foo package`)."""
    text = _NOISE.sub(" ", description[:_MAX_DESCRIPTION_CHARACTERS]).strip()
    if not _PLACEHOLDER.fullmatch(text):
        yield from split_sentences(text, _MAX_DESCRIPTION_SENTENCES)


@lru_cache(maxsize=2**14)
def name_tokens(name: str) -> Tokens:
    """Return a name's words: parted at signs, at camel humps, and at a number after a word.

    The letters before a number are a word if there are four or more: `turtlebot3`, but not `tf2`.
    A leading `lib` is no word.
    """
    humps = (hump for run in _RUN.findall(name[:_MAX_LENGTH]) for hump in _CAMEL.split(run))
    return tokenize(word for hump in humps for word in split_number(hump))


def split_number(word: str) -> list[str]:
    """Return a word as one word, or as the word and the number that it ends in."""
    numbered = _NUMBERED.fullmatch(word)
    parts = numbered.groups() if numbered else (word,)
    return [_LIBRARY.sub("", part) for part in parts]


def tokenize(words: Iterable[str]) -> Tokens:
    """Return words as tokens; a word of more than 40 letters is cut."""
    cut = tuple(word[:_MAX_WORD_LENGTH].lower() for word in words)
    return Tokens(cut, tuple(map(stem, cut)))


@lru_cache(maxsize=_CACHE_SIZE)
def stem(word: str) -> str:
    """Return what a lower-case word has in common with its variants (English, Snowball)."""
    return str(_STEMMER.stemWord(word))
