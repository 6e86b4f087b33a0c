"""A scan of every app below a folder, and the table of what was found."""
