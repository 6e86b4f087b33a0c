"""Measures Zenoh, as `rtron secure --zenoh` configures it."""
