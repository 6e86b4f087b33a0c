"""Benchmarks of the security service."""
