"""Benchmarks on loopback: `python -m bench [PART ...]` from the root of the checkout.

It writes build/bench.json, `{name: {ours, peer, ratio, unit}}` with the ranges over interleaved
runs, after every figure and prints a table at the end. With PARTs it measures only these and keeps
the others' figures. A run of all takes about two hours; `common/workload.py` tells which variables
of the environment shorten it.
The parts that send messages need ROS 1 (Debian's rosmaster and topic_tools).

Messages come from a process of our own (`generator`) and go to another (`receiver`), both much
lighter than a client library, so that what is measured is what stands between them.
"""
