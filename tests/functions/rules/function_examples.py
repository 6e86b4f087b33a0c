"""The examples that stand beside each rule: what it must match, and what it must not."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rtron.functions.text import name_tokens, split_sentences

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from rtron.functions.rules.code_rules import FunctionRule
    from rtron.functions.text import Tokens

_MOST_SENTENCES = 3


def failing_examples(rules: Iterable[FunctionRule]) -> Iterator[str]:
    """Yield a line for each example that its rule takes otherwise than it says."""
    for rule in rules:
        yield from (
            f"{rule.id} misses {text!r}" for text in rule.matches if not _matches(rule, text)
        )
        yield from (f"{rule.id} takes {text!r}" for text in rule.excludes if _matches(rule, text))


def _matches(rule: FunctionRule, text: str) -> bool:
    return any(rule.matches_text(tokens) for tokens in _tokens(text))


def _tokens(text: str) -> Iterable[Tokens]:
    return split_sentences(text, _MOST_SENTENCES) if " " in text else (name_tokens(text),)
