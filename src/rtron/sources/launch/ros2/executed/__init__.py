"""Launch files executed, where the user asks for it: nothing that they start is started."""
