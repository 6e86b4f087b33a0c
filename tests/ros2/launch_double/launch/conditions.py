from launch.core import normalize, perform


class IfCondition:
    def __init__(self, predicate_expression):
        self.expression = normalize(predicate_expression)

    def evaluate(self, context):
        return perform(context, self.expression).lower() in ("true", "1")


class UnlessCondition(IfCondition):
    def evaluate(self, context):
        return not super().evaluate(context)
