"""Recordings of `basrelief run --rtl FILE`: parsed, and joined to the events of one stage."""

import json


class Recording:
    """Everything that crossed the wires of a run."""

    def __init__(self, path):
        self.path = str(path)
        self.stages, self.fifos, self.clients = [], [], []
        self.fields, self.latency, self.tables, self.credits = {}, {}, {}, {}
        self.steps, self.visible, self.answers, self.in_flight = {}, {}, {}, {}
        times = {}
        with open(path, encoding="utf-8") as file:
            for line in file:
                kind, _, rest = line.rstrip("\n").partition(" ")
                getattr(self, "_" + kind)(rest, times)
        for stage, steps in self.steps.items():
            for step, (start, end) in zip(steps, times.get(stage, []), strict=True):
                step.update(start=start, end=end)

    def _config(self, rest, _):
        self.config = json.loads(rest)

    def _machine(self, rest, _):
        self.machine = rest

    def _stage(self, rest, _):
        # The numeral may contain spaces.
        words = rest.split(" ")
        names = [[] if word == "-" else word.split(",") for word in words[-3:]]
        self.stages.append(dict(name=words[1], inputs=names[0], outputs=names[1], clients=names[2]))

    def _fifo(self, rest, _):
        _, name, depth = rest.split()
        self.fifos.append(dict(name=name, depth=int(depth)))

    def _client(self, rest, _):
        _, name, credits = rest.split()
        self.clients.append(dict(name=name, credits=int(credits)))

    def _W(self, rest, _):
        words = rest.split()
        step = dict(taken=int(words[1]), given={}, requests=[])
        for word in words[2:]:
            if word[0] in "rwl":
                client, address, size = map(int, word[1:].split(":"))
                step["requests"].append((word[0], client, address, size))
            else:
                output, bits = word.split(":")
                step["given"][int(output)] = int(bits, 16)
        self.steps.setdefault(int(words[0]), []).append(step)

    def _T(self, rest, times):
        stage, start, end = map(int, rest.split())
        times.setdefault(stage, []).append((start, end))

    def _V(self, rest, _):
        fifo, cycle = map(int, rest.split())
        self.visible.setdefault(fifo, []).append(cycle)

    def _A(self, rest, _):
        stage, step, *answers = map(int, rest.split())
        self.answers.setdefault(stage, {})[step] = answers

    def _M(self, rest, _):
        client, cycle, requests = map(int, rest.split())
        self.in_flight.setdefault(client, []).append((cycle, requests))

    def _credits(self, rest, _):
        stage, *credits = map(int, rest.split())
        self.credits[stage] = credits

    def _output(self, rest, _):
        stage, output, latency, *fields = rest.split()
        name = self.stages[int(stage)]["outputs"][int(output)]
        self.latency[name] = int(latency)
        self.fields[name] = [(field, int(first), int(bits)) for field, first, bits in (f.split(":") for f in fields)]

    def _table(self, rest, _):
        stage, name, _, *entries = rest.split()
        self.tables.setdefault(int(stage), {})[name] = [int(entry, 16) for entry in entries]

    def _end(self, rest, _):
        self.end = int(rest)

    def stage(self, name):
        """Returns the number of a stage."""
        return next(number for number, stage in enumerate(self.stages) if stage["name"] == name)

    def fifo(self, name):
        """Returns the number of a FIFO."""
        return next(number for number, fifo in enumerate(self.fifos) if fifo["name"] == name)

    def end_of(self, name, is_producer):
        """Returns the steps that push tokens to a FIFO, or pop tokens from it, with the bits of the token."""
        key = "outputs" if is_producer else "inputs"
        stage = next(number for number, stage in enumerate(self.stages) if name in stage[key])
        port = self.stages[stage][key].index(name)
        steps = self.steps.get(stage, [])
        if is_producer:
            return [(step["start"], step["given"][port]) for step in steps if port in step["given"]]
        return [step["start"] for step in steps if step["taken"] >> port & 1]

    def port_cycles(self, requests, k, cache):
        """Returns the cycles in which a step issues look-ups and requests through a memory client, which may have a cache."""
        cycles = sum(kind in "rw" and client == k for kind, client, *_ in requests)
        if cache:
            config = self.config["cache"][cache]
            looked_up = [(address, size) for kind, client, address, size in requests if kind == "l" and client == k]
            size = config["line_bytes"]
            lines = {line for address, count in looked_up for line in range(address // size, (address + count - 1) // size + 1)}
            cycles += -(-len(lines) // config["lookups_per_cycle"])
        return cycles

    def number(self, stage, name):
        """Returns a table of one number."""
        return self.tables[stage][name][0]


def width(fields):
    """Returns the bits of a token."""
    return max(first + bits for _, first, bits in fields)


def value(token, fields, name):
    """Returns a field of a token."""
    _, first, bits = next(field for field in fields if field[0] == name)
    return token >> first & ((1 << bits) - 1)


def replaced(token, fields, name, new):
    """Returns a token with another value in a field."""
    _, first, bits = next(field for field in fields if field[0] == name)
    return token & ~(((1 << bits) - 1) << first) | new << first
