"""Synthetic vectors: random tokens of a unit's contract, with random backpressure and answer times, and the cycles that the laws of time give.

The expected results come from the few lines of Python below, which share no code with the simulator. All numbers come from a seed.
"""

import random

from channel_vectors import SEEDS as CHANNEL_SEEDS
from channel_vectors import channel_vectors
from recording import Recording, replaced, value

TOKENS = 400
FIGURE, DOT, END = 1, 2, 3


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
        for o, fifo in enumerate(outputs):
            consumer = next(n for n, s in enumerate(self.stages) if fifo in s["inputs"])
            mask = 1 << self.stages[consumer]["inputs"].index(fifo)
            pops = [dict(start=pop, end=pop + 1, taken=mask, given={}, requests=[]) for pop in wires[fifo].pops]
            self.steps[consumer] = sorted(self.steps.get(consumer, []) + pops, key=lambda step: step["start"])
        for fifo, wire in wires.items():
            self.visible[self.fifo(fifo)] = wire.visible
        self.end = max(free, *(max([0, *wire.pops, *wire.visible]) for wire in wires.values())) + 1
        return self


def gate(base, seed):
    """Returns vectors of gate (51)."""
    made = Synthetic(base, "gate", seed)
    fields, config, rng = made.fields["highlights"], base.config["gate"], made.random
    tokens, is_open = [], False
    for _ in range(TOKENS):
        kind = rng.choice([FIGURE, DOT, DOT, DOT, END])
        dot = dict(x=rng.getrandbits(16), y=rng.getrandbits(16), brightness=rng.getrandbits(32)) if kind == DOT else {}
        tokens.append(token(fields, kind=kind, **dot, **(dict(open=rng.getrandbits(1)) if kind == FIGURE else {})))

    def steps(bits):
        nonlocal is_open
        kind = value(bits, fields, "kind")
        if kind == FIGURE:
            is_open = bool(value(bits, fields, "open"))
        given = {0: bits} if kind != FIGURE and is_open else {}
        yield config["initiation_interval"] if kind == DOT else 1, config["latency"], given, [], False

    return made.generate(tokens, steps)


def register_bank(base, seed):
    """Returns vectors of the registers (14), (16) and (18)."""
    made = Synthetic(base, "registers", seed)
    fields, out, rng = made.fields["figures"], made.fields["selections"], made.random
    registers, tokens = dict(mode=0, flat=0, specular=0), []
    for _ in range(TOKENS):
        if rng.random() < 0.5:
            register = rng.choice([14, 16, 18])
            tokens.append(token(fields, register=register, value=rng.randrange(3 if register == 14 else 2)))
        else:
            kind = rng.choice([FIGURE, DOT, END])
            body = dict(flow_red=rng.getrandbits(32), flow_x=rng.getrandbits(16)) if kind == DOT else {}
            body = dict(flow_mode=rng.randrange(3), flow_flat=rng.getrandbits(1)) if kind == FIGURE else body
            tokens.append(token(fields, **{"pass": 1}, flow_kind=kind, **body))

    def steps(bits):
        if not bits & 1:
            name = {14: "mode", 16: "flat", 18: "specular"}[value(bits, fields, "register")]
            registers[name] = value(bits, fields, "value")
            yield 1, 1, {}, [], False
            return
        passed = bits >> 1
        if value(passed, out, "kind") == FIGURE:
            for name, number in registers.items():
                passed = replaced(passed, out, name, number)
        yield 1, 1, {0: passed}, [], False

    return made.generate(tokens, steps)


def distributor(base, seed):
    """Returns vectors of the distributor."""
    made = Synthetic(base, "distributor", seed)
    fields, rng = made.fields[made.stages[made.only]["inputs"][0]], made.random
    tokens, plain = [], False
    for _ in range(TOKENS):
        if rng.random() < 0.6:
            tokens.append(token(fields, item=1, count=rng.randint(1, 4), **{"0_x": rng.getrandbits(16)}))
        else:
            tokens.append(token(fields, kind=rng.choice([0, 1, 2, 2, 4]), number=rng.getrandbits(8)))
            if value(tokens[-1], fields, "kind") == 2:
                tokens[-1] = replaced(tokens[-1], fields, "bump", rng.getrandbits(1))

    def steps(bits):
        nonlocal plain
        if bits & 1:
            yield 1, 0, {1 if plain else 0: bits}, [], False
            return
        begins = value(bits, fields, "kind") == 2 and not value(bits, fields, "bump")
        given = {0: bits, 1: bits} if plain or begins else {0: bits}
        plain = begins
        yield 1, 0, given, [], False

    return made.generate(tokens, steps)


def replacement(base, seed):
    """Returns vectors of the normal-vector replacement unit (110): tables with many equal entries, so that most searches have ties."""
    config, rng = base.config["replacement"], random.Random(f"tables {seed}")
    few = [[rng.choice([-32767, -20000, 0, 1, 20000, 32767]) for _ in range(3)] for _ in range(40)]
    tables = [[rng.choice(few) for _ in range(config["entries"])] for _ in range(8)]
    pack = lambda normal: sum((c & 0xFFFF) << 16 * i for i, c in enumerate(normal))  # noqa: E731
    made = Synthetic(base, "replacement", seed, {f"normals.{level}": [pack(n) for n in table] for level, table in enumerate(tables)})
    fields, out, rng = made.fields["pseudo_normals"], made.fields["indexes"], made.random
    latency, size = base.number(made.only, "latency"), config["entries"] * base.number(made.only, "entry_bytes")
    rows, resident, tokens = -(-config["entries"] // config["lanes"]), [], []
    for _ in range(TOKENS // 4):
        samples, count, values = rng.randint(1, 2), rng.randint(1, 4), {}
        if rng.random() < 0.2:
            tokens.append(token(fields, kind=rng.choice([0, 1, 2, 4]), number=rng.getrandbits(20)))
            continue
        first = rng.randrange(7)
        for sample in range(samples):
            values[f"sample_{sample}_level"] = first + sample
            for lane in range(count):
                normal = rng.choice([[0, 0, 0], [32767, -32767, 32767], *few, [rng.randint(-32767, 32767) for _ in range(3)]])
                values.update({f"sample_{sample}_{lane}_n{axis}": c & 0xFFFF for axis, c in zip("xyz", normal)})
                values[f"sample_{sample}_{lane}_share"] = rng.randint(0, 128)
        tokens.append(token(fields, item=1, stamp_count=count, stamp_0_x=rng.getrandbits(16), samples=samples, **values))

    def signed(bits, name):
        number = value(bits, fields, name)
        return number - 65536 if number > 32767 else number

    def steps(bits):
        if not bits & 1:
            yield 1, latency, {0: bits}, [], False
            return
        samples, count = value(bits, fields, "samples"), value(bits, fields, "stamp_count")
        levels = [value(bits, fields, f"sample_{sample}_level") for sample in range(samples)]
        missing = []
        for level in levels:
            if level in resident:
                resident.remove(level)
            else:
                missing.append(level)
                del resident[1:]
            resident.insert(0, level)
        reads = [(level * (512 << 10) + at, min(config["load_bytes"], size - at)) for level in missing for at in range(0, size, config["load_bytes"])]
        for number, (address, length) in enumerate(reads):
            yield 1, latency, {}, [("r", 0, address, length)], number + 1 == len(reads)
        result = token(out, **{name: value(bits, fields, name) for name, *_ in out if not name.endswith("index") and not shares(name)})
        for sample, level in enumerate(levels):
            for lane in range(count):
                normal = [signed(bits, f"sample_{sample}_{lane}_n{axis}") for axis in "xyz"]
                dots = [sum(a * b for a, b in zip(normal, entry)) for entry in tables[level]]
                result = replaced(result, out, f"sample_{sample}_{lane}_index", dots.index(max(dots)))
        cycles = samples * count * rows
        yield cycles, latency + cycles - 1, {0: result}, [], False

    return made.generate(tokens, steps)


def shares(name):
    """Returns true for a field of control, which shares its bits with items."""
    return name in ("kind", "number", "width", "height", "bump", "lod", "mapped", "textured", "triangles")


# Generators of vectors by unit, with the machine whose fields they use.
GENERATORS = {"gate": gate, "register_bank": register_bank, "distributor": distributor, "replacement": replacement, "channel": channel_vectors}
SEEDS = 2


def vectors(unit, recordings, machine):
    """Returns the synthetic vectors of a unit, if a recording of its machine gives the fields."""
    base = next((r for r in recordings if r.machine == machine), None)
    if base is None or unit not in GENERATORS:
        return []
    return [GENERATORS[unit](base, seed) for seed in range(CHANNEL_SEEDS if unit == "channel" else SEEDS)]
