"""Visits a launch file with the real launch library, in a process of its own.

This runs in the Python of a ROS 2, where no RTron need be: nothing here imports what is outside of
this folder, launch and Python's library.
"""
