from evaluation.place import AbsentError
def figures(here, tell):
    raise AbsentError("todo")
    yield
