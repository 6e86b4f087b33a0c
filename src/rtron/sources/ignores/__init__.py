"""What people do not want to be told again: `rtron.toml`, and comments in launch files and code."""
