"""Launch files in Python: their AST is interpreted to actions, nothing is run."""
