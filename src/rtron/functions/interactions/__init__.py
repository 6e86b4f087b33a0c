"""Which messages the functions of a robot exchange: what is typical, as data."""
