"""The rules that tell a function type from words: data, one file per type, and their loading."""
