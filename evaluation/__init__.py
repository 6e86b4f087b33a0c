"""Evaluation of extraction and classification: `python -m evaluation [PART ...] [-v]`.

It scans real apps where they are present and compares with what was observed in them, with what
was read in their source by hand, and with what the peer ROSDiscover reports for them; and it
classifies corpora of repositories, some labelled by hand, beside the paper's figures. Two
variables of the environment tell where: RTRON_APPS is a folder of repositories laid out as
owner/name@commit, RTRON_DATA one that holds `groundtruth/` and `corpus/`. What is absent is said
and skipped.

It writes build/eval.json, `{name: {ours, peer, ratio, unit}}`, after every figure and prints a
table at the end; -v lists every pair that was missed or invented. Nothing of the apps is run.
"""
