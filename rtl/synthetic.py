"""Synthetic vectors: random tokens of a unit's contract, with random backpressure and answer times, and the cycles that the laws of time give.

The expected results come from the few lines of Python below, which share no code with the simulator. All numbers come from a seed.
"""

import dataclasses
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


@dataclasses.dataclass
class Made:
    """Step of a unit. Requests are kind, client, address and bytes."""

    occupancy: int
    latency: int
    given: dict
    requests: list = dataclasses.field(default_factory=list)
    is_blocking: bool = False
    # Cycles from the last answer to the delivery.
    after: int = 0


class Synthetic(Recording):
    """Vectors of one stage, in the form of a recording."""

    def __init__(self, base, stage_name, seed, tables=None, caches=None):
        self.path = f"synthetic-{seed}"
        self.machine, self.config, self.fields, self.stages = base.machine, base.config, base.fields, base.stages
        self.clients, self.credits, self.in_flight, self.caches = base.clients, base.credits, {}, caches or {}
        self.random = random.Random(f"{stage_name} {seed}")
        stage = self.only = base.stage(stage_name)
        self.tables = {**base.tables, stage: {**base.tables.get(stage, {}), **(tables or {})}}
        # All seeds have the same depths and latencies, so that they share a build.
        sizes = random.Random(stage_name)
        self.fifos = [dict(fifo, depth=sizes.randint(1, 6)) for fifo in base.fifos]
        self.latency = {name: sizes.randint(1, 3) for name in base.latency}
        self.steps, self.visible, self.answers, self.end = {stage: []}, {}, {stage: {}}, 0

    def generate(self, tokens, steps_of):
        """Executes the laws of time for a unit with one input. `steps_of(bits)` yields the steps of a token: occupancy, latency, tokens by output,
        requests, and true if the step is blocking."""
        pending = []

        def step(taken):
            pending.extend(Made(*made) for bits in taken.values() for made in steps_of(bits))
            return pending.pop(0)

        return self.execute([tokens], lambda: [] if pending else [0], step)

    def join(self, streams, demand, step):
        """As `generate`, for a unit with several inputs. `demand()` returns the inputs that the next step pops, `step(tokens)` its occupancy, latency and
        tokens by output."""
        return self.execute(streams, demand, lambda taken: Made(*step(taken)))

    def execute(self, streams, demand, step):
        """Executes the laws of time, with random backpressure, answer times and pauses of memory clients. Ends with the first input that has no
        token. `step(tokens)` returns a `Made`."""
        names = self.stages[self.only]
        inputs, outputs = names["inputs"], names["outputs"]
        wires = {fifo: Wire(self.fifos[self.fifo(fifo)]["depth"], self.latency[fifo]) for fifo in [*inputs, *outputs]}
        pauses, after_pops = [self.random.choice([0, 3, 20]) for _ in inputs], self.random.choice([0, 3, 20])
        produced, delivered, taken, fronts, free, answered = [0] * len(inputs), [0] * len(inputs), [0] * len(inputs), {}, 0, 0
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
            made = step({i: fronts.pop(i)[0] for i in needed})
            for i in needed:
                wires[inputs[i]].pops.append(start)
            free, shown = start + made.occupancy, start + made.latency
            taken_inputs = sum(1 << i for i in needed)
            self.steps[self.only].append(dict(start=start, end=free, taken=taken_inputs, given=made.given, requests=made.requests))
            if any(kind in "rl" for kind, *_ in made.requests):
                answered = max(answered, start + self.random.randint(1, 40))
                self.answers[self.only][len(self.steps[self.only]) - 1] = [answered]
                shown = max(shown, answered + made.after)
                free = max(free, answered) if made.is_blocking else free
            free = max(free, self.clients_after(start, made.requests))
            for o, _ in sorted(made.given.items()):
                wire = wires[outputs[o]]
                wire.pops.append(max([wire.deliver(shown), *(last + 1 for last in wire.pops[-1:])]) + self.random.randint(0, after_pops))

    def clients_after(self, start, requests):
        """Returns the first cycle in which the memory clients are ready after the requests of a step. Now and then, a client pauses: it has more requests
        in flight than its credits."""
        ready = start + 1
        for k, client in enumerate(self.stages[self.only]["clients"]):
            if any(of == k for _, of, *_ in requests):
                ready = max(ready, start + self.port_cycles(requests, k, self.caches.get(k)))
                if self.random.random() < 0.1:
                    number = next(number for number, other in enumerate(self.clients) if other["name"] == client)
                    ready += self.random.randint(1, 30)
                    self.in_flight.setdefault(number, []).extend([(start + 1, self.clients[number]["credits"] + 1), (ready, 0)])
        return ready

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
