"""Synthetic vectors: random tokens of a unit's contract, with random backpressure and answer times, and the cycles that the laws of time give.

The expected results come from the few lines of Python below, which share no code with the simulator. All numbers come from a seed.
"""

import random

from recording import Recording, replaced

TOKENS = 400


def token(fields, **values):
    """Returns the bits of a token with these fields."""
    bits = 0
    for name, number in values.items():
        bits = replaced(bits, fields, name, number)
    return bits


class Wire:
    """Times of a FIFO by laws 1 and 2."""

    def __init__(self, depth, latency):
        self.depth, self.latency = depth, latency
        self.visible, self.pops = [], []

    def room(self):
        """Returns the first cycle in which the next token finds a slot."""
        number = len(self.visible) - self.depth
        return self.pops[number] + 1 if number >= 0 else 0

    def deliver(self, cycle):
        """Returns the first cycle in which a token delivered in `cycle` is visible."""
        self.visible.append(max([cycle + self.latency, *(last + 1 for last in self.visible[-1:])]))
        return self.visible[-1]


class Synthetic(Recording):
    """Vectors of one stage, in the form of a recording."""

    def __init__(self, base, stage_name, seed, tables=None):
        self.path = f"synthetic-{seed}"
        self.machine, self.config, self.fields, self.stages = base.machine, base.config, base.fields, base.stages
        self.clients, self.credits, self.in_flight = base.clients, base.credits, {}
        self.random = random.Random(f"{stage_name} {seed}")
        stage = self.only = base.stage(stage_name)
        self.tables = {**base.tables, stage: {**base.tables.get(stage, {}), **(tables or {})}}
        self.fifos = [dict(fifo, depth=self.random.randint(1, 6)) for fifo in base.fifos]
        self.latency = {name: self.random.randint(1, 3) for name in base.latency}
        self.steps, self.visible, self.answers, self.end = {stage: []}, {}, {stage: {}}, 0
        self.producer = next(n for n, s in enumerate(base.stages) if self.stages[stage]["inputs"][0] in s["outputs"])

    def generate(self, tokens, steps_of):
        """Executes the laws of time. `steps_of(bits)` yields the steps of a token: occupancy, latency, tokens by output, requests, and true if
        the step is blocking."""
        names = self.stages[self.only]
        [name], outputs = names["inputs"], names["outputs"]
        wires = {fifo: Wire(self.fifos[self.fifo(fifo)]["depth"], self.latency[fifo]) for fifo in [name, *outputs]}
        port = self.stages[self.producer]["outputs"].index(name)
        pauses = self.random.choice([0, 3, 20])
        free = produced = delivered = answered = 0
        for bits in tokens:
            produced = max(produced + 1, wires[name].room()) + self.random.randint(0, pauses)
            delivered = max(delivered + 1, produced + self.random.randint(0, 5))
            visible = wires[name].deliver(delivered)
            self.steps.setdefault(self.producer, []).append(dict(start=produced, end=produced + 1, taken=0, given={port: bits}, requests=[]))
            for taken, (occupancy, latency, given, requests, is_blocking) in enumerate(steps_of(bits)):
                start = max([free, *(wires[fifo].room() for fifo in outputs), visible if taken == 0 else 0])
                if taken == 0:
                    wires[name].pops.append(start)
                free = start + occupancy
                if is_blocking:
                    answered = max(answered, start + self.random.randint(1, 40))
                    self.answers[self.only][len(self.steps[self.only])] = [answered]
                    free = max(free, answered)
                for o, _ in sorted(given.items()):
                    wire = wires[outputs[o]]
                    shown = wire.deliver(start + latency)
                    wire.pops.append(max([shown, *(last + 1 for last in wire.pops[-1:])]) + self.random.randint(0, pauses))
                self.steps[self.only].append(dict(start=start, end=start + occupancy, taken=int(taken == 0), given=given, requests=requests))
        return self.finish(wires, outputs, free)

    def join(self, streams, demand, step):
        """As `generate`, for a unit with several inputs. `demand()` returns the inputs that the next step pops, `step(tokens)` its occupancy, latency and
        tokens by output. Ends with the first input that has no token."""
        names = self.stages[self.only]
        inputs, outputs = names["inputs"], names["outputs"]
        wires = {fifo: Wire(self.fifos[self.fifo(fifo)]["depth"], self.latency[fifo]) for fifo in [*inputs, *outputs]}
        pauses = [self.random.choice([0, 3, 20]) for _ in inputs]
        produced, delivered, taken, fronts, free = [0] * len(inputs), [0] * len(inputs), [0] * len(inputs), {}, 0
        while True:
            needed = demand()
            for i in needed:
                if i in fronts:
                    continue
                if taken[i] == len(streams[i]):
                    return self.finish(wires, outputs, free)
                produced[i] = max(produced[i] + 1, wires[inputs[i]].room()) + self.random.randint(0, pauses[i])
                delivered[i] = max(delivered[i] + 1, produced[i] + self.random.randint(0, 5))
                fronts[i] = streams[i][taken[i]], wires[inputs[i]].deliver(delivered[i])
                self.produce(inputs[i], produced[i], fronts[i][0])
                taken[i] += 1
            start = max([free, *(wires[fifo].room() for fifo in outputs), *(fronts[i][1] for i in needed)])
            occupancy, latency, given = step({i: fronts.pop(i)[0] for i in needed})
            free = start + occupancy
            for i in needed:
                wires[inputs[i]].pops.append(start)
            for o, _ in sorted(given.items()):
                wire = wires[outputs[o]]
                shown = wire.deliver(start + latency)
                wire.pops.append(max([shown, *(last + 1 for last in wire.pops[-1:])]) + self.random.randint(0, 5))
            self.steps[self.only].append(dict(start=start, end=free, taken=sum(1 << i for i in needed), given=given, requests=[]))

    def produce(self, fifo, cycle, bits):
        """Adds the step that makes a token of an input."""
        producer = next(n for n, stage in enumerate(self.stages) if fifo in stage["outputs"])
        port = self.stages[producer]["outputs"].index(fifo)
        self.steps.setdefault(producer, []).append(dict(start=cycle, end=cycle + 1, taken=0, given={port: bits}, requests=[]))

    def finish(self, wires, outputs, free):
        """Adds the steps of the consumers, and the end."""
        for o, fifo in enumerate(outputs):
            consumer = next(n for n, s in enumerate(self.stages) if fifo in s["inputs"])
            mask = 1 << self.stages[consumer]["inputs"].index(fifo)
            pops = [dict(start=pop, end=pop + 1, taken=mask, given={}, requests=[]) for pop in wires[fifo].pops]
            self.steps[consumer] = sorted(self.steps.get(consumer, []) + pops, key=lambda step: step["start"])
        for fifo, wire in wires.items():
            self.visible[self.fifo(fifo)] = wire.visible
        self.end = max(free, *(max([0, *wire.pops, *wire.visible]) for wire in wires.values())) + 1
        return self
