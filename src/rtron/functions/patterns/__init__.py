"""Patterns over the words of a text, like TokensRegex: compiled once, found by their first word."""
