"""Benchmarks: `python -m bench [PART ...]` measures on loopback and writes build/bench.json."""
