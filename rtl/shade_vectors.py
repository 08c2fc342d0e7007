"""Synthetic vectors of units of the figure shading device."""

from floats import rounded, single_bits, single_of
from recording import replaced, value
from synthetic import TOKENS, Synthetic, token

FIGURE, DOT, END = 1, 2, 3


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


def brightness(rng, near=None):
    """Returns the bits of a number that is finite, even after an addition: of any size, close to another one with the other sign, or subnormal."""
    if near is not None and rng.random() < 0.3:
        return near ^ 1 << 31 ^ rng.getrandbits(3)
    exponent = rng.choice([0, rng.randrange(240), rng.randrange(110, 140)])
    return rng.getrandbits(1) << 31 | exponent << 23 | rng.getrandbits(23)


def dots(fields, rng):
    """Returns a token of a dot."""
    colours = {name: brightness(rng) for name in ("red", "green", "blue")}
    return token(fields, kind=DOT, x=rng.getrandbits(16), y=rng.getrandbits(16), **colours)


def adder(base, seed):
    """Returns vectors of the adder (52): sums with cancellation, ties and subnormal numbers."""
    made = Synthetic(base, "adder", seed)
    (first, second), rng, config = made.stages[made.only]["inputs"], made.random, base.config["adder"]
    fields, highlight = made.fields[first], made.fields[second]
    streams, joins = [[], []], False
    for _ in range(TOKENS // 4):
        selected = dict(mode=rng.choice([0, 0, 0, 1, 2]), flat=rng.choice([0, 0, 1]), specular=rng.choice([0, 1, 1]))
        streams[0].append(token(fields, kind=FIGURE, **selected))
        has_highlights = selected == dict(mode=0, flat=0, specular=1)
        for _ in range(rng.randrange(6)):
            streams[0].append(dots(fields, rng))
            if has_highlights:
                near = value(streams[0][-1], fields, rng.choice(["red", "green", "blue"]))
                streams[1].append(token(highlight, kind=DOT, brightness=brightness(rng, near)))
        streams[0].append(token(fields, kind=END))
        streams[1] += [token(highlight, kind=END)] * has_highlights

    def step(tokens):
        nonlocal joins
        bits = tokens[0]
        kind = value(bits, fields, "kind")
        if kind == DOT and joins:
            more = single_of(value(tokens[1], highlight, "brightness"))
            for name in ("red", "green", "blue"):
                bits = replaced(bits, fields, name, single_bits(single_of(value(bits, fields, name)) + more))
        if kind != DOT:
            joins = kind == FIGURE and [value(bits, fields, name) for name in ("mode", "flat", "specular")] == [0, 0, 1]
        return config["initiation_interval"] if kind == DOT else 1, base.number(made.only, "latency"), {0: bits}

    return made.join(streams, lambda: [0, 1] if joins else [0], step)


def selector_53(base, seed):
    """Returns vectors of selector (53)."""
    made = Synthetic(base, "selector-53", seed)
    (first, _), rng, config = made.stages[made.only]["inputs"], made.random, base.config["selector_53"]
    fields, flat, streams = made.fields[first], False, [[], []]
    for _ in range(TOKENS // 4):
        selected = dict(mode=rng.choice([0, 0, 1]), flat=rng.getrandbits(1))
        streams[0].append(token(fields, kind=FIGURE, **selected))
        of = streams[1 if selected == dict(mode=0, flat=1) else 0]
        of += [dots(fields, rng) for _ in range(rng.randrange(6))]
        of.append(token(fields, kind=END))

    def step(tokens):
        nonlocal flat
        bits = tokens[1 if flat else 0]
        kind = value(bits, fields, "kind")
        if kind == FIGURE:
            flat = value(bits, fields, "mode") == 0 and value(bits, fields, "flat") == 1
        elif kind == END:
            flat = False
        return config["initiation_interval"] if kind == DOT else 1, config["latency"], {0: bits}

    return made.join(streams, lambda: [1] if flat else [0], step)


def to_byte(bits):
    """Returns a component as a byte: each operation rounds to single precision."""
    scaled = rounded(single_of(bits) * 255.0)
    return min(max(int(rounded(scaled + 0.5)), 0), 255)


def selector_28(base, seed):
    """Returns vectors of selector (28): components at the steps of a byte, below 0 and above 1."""
    made = Synthetic(base, "selector-28", seed)
    names, rng, config = made.stages[made.only], made.random, base.config["selector_28"]
    fields, out = made.fields[names["inputs"][0]], made.fields[names["outputs"][0]]
    streams, selected = [[], [], []], 0
    for _ in range(TOKENS // 4):
        mode, flat = rng.randrange(3), rng.getrandbits(1)
        streams[0].append(token(fields, kind=FIGURE, mode=mode, flat=flat))
        of = streams[0 if mode == 0 else 2 if mode == 2 or flat else 1]
        for _ in range(rng.randrange(6)):
            colours = {name: rng.choice([brightness(rng), single_bits(rng.randrange(511) / 510), single_bits(rng.random())]) for name in ("red", "green", "blue")}
            of.append(token(fields, kind=DOT, x=rng.getrandbits(16), y=rng.getrandbits(16), **colours))
        of.append(token(fields, kind=END))

    def step(tokens):
        nonlocal selected
        (bits,) = tokens.values()
        kind, mode = value(bits, fields, "kind"), value(bits, fields, "mode")
        if kind == FIGURE:
            selected = 0 if mode == 0 else 2 if mode == 2 or value(bits, fields, "flat") else 1
            return 1, config["latency"], {}
        if kind == END:
            selected = 0
            return 1, config["latency"], {1: 1}
        rgb = sum(to_byte(value(bits, fields, name)) << 8 * c for c, name in enumerate(("red", "green", "blue")))
        place = {f"0_{name}": value(bits, fields, name) for name in "xyz"}
        return config["initiation_interval"], config["latency"], {0: token(out, item=1, count=1, **{"0_rgb": rgb}, **place)}

    return made.join(streams, lambda: [selected], step)
