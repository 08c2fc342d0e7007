"""The geometry processor (102): parameters and commands of its twin."""

from recording import width


def geometry(recording, _):
    """Returns the parameters: latencies of the operators."""
    names = dict(MULTIPLY="multiply", ADD="add", DIVIDE="divide", ROOT="square_root", POWER="power")
    return {parameter: recording.config["operators"][name]["latency"] for parameter, name in names.items()}


def geometry_tokens(recording, stage, inputs, outputs, tokens):
    """Adds to each draw command the recorded cycles of its step, and whether the step gives a token."""
    [(fields, depth, latency)] = inputs
    first = width(fields)
    for index, step in enumerate(recording.steps[stage]):
        tokens["in"][0][index] |= step["end"] - step["start"] << first | bool(step["given"]) << first + 16
    return [([*fields, ("cycles", first, 16), ("drawn", first + 16, 1)], depth, latency)], outputs
