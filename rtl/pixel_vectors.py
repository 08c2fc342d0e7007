"""Synthetic vectors of the units that own a memory of pixels, and of the brightness fetch unit."""

from floats import single_bits
from recording import replaced, value
from synthetic import TOKENS, Made, Synthetic, token
from twins import CLUTS, VQ_STRIDE, clut_stride

FRAME, OBJECT, POLYGON, FRAME_END = 0, 1, 2, 4
# Address of the z-buffer, and distance between two buffers of the swap chain.
Z_BUFFER, BUFFER = 0x1000_2000, 1 << 27
# Buffers from the third on lie behind everything else.
LATER_BUFFERS = 1 << 40


class Picture:
    """Lines of a picture: gathered ones, clear ones with flags, and those beyond the flags."""

    def __init__(self, config, limit):
        self.config, self.limit = config, limit
        self.gathered, self.clear, self.unflagged, self.flagged, self.next = [], set(), [], 0, 0

    def begin(self, lines):
        """Begins a frame. Returns the cycles that the flags take."""
        self.flagged = min(lines, self.limit)
        self.gathered, self.clear, self.unflagged, self.next = [], set(range(self.flagged)), list(range(self.flagged, lines)), 0
        return max(-(-self.flagged // self.config["flags_per_cycle"]), 1)

    def touch(self, line):
        """Gathers a line. Returns the line that it evicts, if any."""
        self.clear.discard(line)
        self.gathered = [other for other in self.gathered if other != line] + [line]
        return [self.gathered.pop(0)] if len(self.gathered) > self.config["write_lines"] else []

    def take_clear(self):
        """Returns the next clear line, if any, and the cycles of the search."""
        found = [line for line in range(self.next, self.flagged) if line in self.clear][:1]
        last = found[0] if found else max(self.flagged - 1, 0)
        cycles = max(last // self.config["flags_per_cycle"] - self.next // self.config["flags_per_cycle"], 1)
        self.clear.difference_update(found)
        self.next = found[0] + 1 if found else self.flagged
        return found, cycles


class Tokens:
    """Tokens of pixels: stamps of fragments in 4 x 4 blocks, or packets of 16 pixels of a row."""

    def __init__(self, made):
        self.made, self.rng = made, made.random
        self.fields = made.fields[made.stages[made.only]["inputs"][0]]
        names = {name for name, *_ in self.fields}
        self.mask = next((name for name in ("packet_mask", "mask") if name in names), None)
        self.lanes = [lane for lane in range(4) if f"{lane}_x" in names]
        # Pixels of a line, across and down.
        self.line = (16, 1) if self.mask else (4, 4)

    def contents(self, lane):
        """Returns random values of the fields of a pixel, with few depths, so that many are equal."""
        fields = [(name, bits) for name, _, bits in self.fields if name.startswith(f"{lane}_") and name[2:] not in "xy" and name[3:] not in "xy"]
        return {name: self.rng.choice([0, 5, 6, 7, (1 << bits) - 1]) if name.endswith("z") else self.rng.getrandbits(bits) for name, bits in fields}

    def frames(self, count):
        """Returns tokens of frames of several sizes, with some pixels outside the picture."""
        rng, tokens = self.rng, []
        for _ in range(count):
            size = [rng.randint(1, 40), rng.randint(1, 20)]
            tokens.append(token(self.fields, kind=FRAME, width=size[0], height=size[1]))
            few = [rng.randrange(-(-size[0] // self.line[0]) * -(-size[1] // self.line[1])) for _ in range(4)]
            for _ in range(rng.choice([0, 3, 40])):
                tokens.append(self.pixels(size, rng.choice(few) if rng.random() < 0.7 else rng.randrange(40)))
                if rng.random() < 0.1:
                    tokens.append(token(self.fields, kind=rng.choice([OBJECT, POLYGON]), number=rng.getrandbits(20)))
            tokens.append(token(self.fields, kind=FRAME_END))
        return tokens

    def pixels(self, size, line):
        """Returns a token of a line of a picture of this size."""
        rng, (across, down), columns = self.rng, self.line, -(-size[0] // self.line[0])
        x, y = line % columns * across, line // columns * down
        if self.mask:
            values = {self.mask: rng.choice([0, 0xFFFF, rng.getrandbits(16)]), self.mask.replace("mask", "x"): x, self.mask.replace("mask", "y"): y}
            for lane in range(16):
                values.update(self.contents(lane))
            return token(self.fields, item=1, **values)
        chosen, values = rng.sample(range(16), rng.randint(1, len(self.lanes))), {}
        for lane, place in enumerate(chosen):
            values.update({f"{lane}_x": x + place % 4, f"{lane}_y": y + place // 4, **self.contents(lane)})
        return token(self.fields, item=1, count=len(chosen), **values)

    def places(self, bits):
        """Returns the pixels of a token: lane, column and row."""
        get = lambda name: value(bits, self.fields, name)  # noqa: E731
        if self.mask:
            x, y = (get(self.mask.replace("mask", axis)) for axis in "xy")
            return [(lane, x + lane, y) for lane in range(16) if get(self.mask) >> lane & 1]
        return [(lane, get(f"{lane}_x"), get(f"{lane}_y")) for lane in range(get("count"))]

    def with_lanes(self, bits, kept):
        """Returns a token with these pixels only. Fragments of a stamp move together."""
        if self.mask:
            return replaced(bits, self.fields, self.mask, sum(1 << lane for lane in kept))
        names = [name[1:] for name, *_ in self.fields if name.startswith("0_")]
        for lane in self.lanes:
            for name in names:
                bits = replaced(bits, self.fields, f"{lane}{name}", value(bits, self.fields, f"{kept[lane]}{name}") if lane < len(kept) else 0)
        return replaced(bits, self.fields, "count", len(kept))


def few_flags(base, name):
    """Returns the configuration with few flags of clear lines, and few gathered lines."""
    return {**base.config, name: {**base.config[name], "flags": 9, "flags_per_cycle": 2, "write_lines": 3}}


def depth_test(base, seed):
    """Returns vectors of the depth test: equal depths, clear lines, lines without flags, evicted lines, pixels outside the picture."""
    made = Synthetic(base, "depth-test", seed, caches={0: "depth"})
    made.config = few_flags(base, "depth") if seed else base.config
    config, latency = made.config["depth"], base.number(made.only, "latency")
    tokens = Tokens(made)
    bits = next(bits for name, _, bits in tokens.fields if name == "0_z")
    size, most = (2 if bits <= 16 else 4), (1 << bits) - 1
    picture, extent, stored = Picture(config, config["flags"] if config["clear_flags"] else 0), [0, 0], {}
    write = lambda line: ("w", 1, Z_BUFFER + line * 16 * size, 16 * size)  # noqa: E731

    def test(token_bits):
        """Tests the pixels of a token. Returns the lanes that pass, and the requests."""
        kept, requests, is_open = [], [], False
        for lane, x, y in tokens.places(token_bits):
            if x >= extent[0] or y >= extent[1]:
                continue
            z, (across, down) = value(token_bits, tokens.fields, f"{lane}_z"), tokens.line
            passes = z < stored.get((x, y), most)
            line = y // down * -(-extent[0] // across) + x // across
            if passes:
                stored[x, y] = z
                kept.append(lane)
            is_open = is_open or picture.gathered[-1:] == [line]
            if not is_open:
                if line not in picture.gathered and line not in picture.clear:
                    within = 0 if passes else (y % down * across + x % across) * size
                    requests.append(("l", 0, Z_BUFFER + line * 16 * size + within, 16 * size if passes else size))
                if passes:
                    requests += [write(gone) for gone in picture.touch(line)]
                    is_open = True
        return kept, requests

    def steps(token_bits):
        kind = value(token_bits, tokens.fields, "kind")
        if token_bits & 1:
            pixels = len(tokens.places(token_bits))
            kept, requests = test(token_bits)
            given = {0: tokens.with_lanes(token_bits, kept)} if kept or tokens.mask else {}
            yield max(pixels, 1), latency + max(pixels - 1, 0), given, requests, False, latency
        elif kind == FRAME:
            extent[:] = (value(token_bits, tokens.fields, name) for name in ("width", "height"))
            stored.clear()
            lines = -(-extent[0] // tokens.line[0]) * -(-extent[1] // tokens.line[1])
            yield picture.begin(lines), latency, {0: token_bits}
            for line in picture.unflagged:
                yield 1, latency, {}, [write(line)]
        elif kind == FRAME_END:
            while True:
                requests = [write(picture.gathered.pop(0))] if picture.gathered else []
                yield 1, latency, {} if picture.gathered else {0: token_bits}, requests
                if not picture.gathered:
                    break
        else:
            yield 1, latency, {0: token_bits}

    return made.generate(tokens.frames(12), steps)


def frame_buffer(base, seed):
    """Returns vectors of the frame buffer: clear lines, lines without flags, evicted lines, empty frames, pixels outside the picture."""
    stage = dict(bump="frame-buffer", shade="frame-memory", texel="pixel-value-buffer")[base.machine]
    made = Synthetic(base, stage, seed)
    made.config = few_flags(base, "frame_buffer") if seed else base.config
    config, tokens = made.config["frame_buffer"], Tokens(made)
    picture, extent, size = Picture(config, config["flags"] if config["clear_flags"] else 0), [0, 0], 16 * config["pixel_bytes"]
    frames = 0

    def write(line):
        buffer = frames % made.config["display"]["buffers"]
        return ("w", 0, buffer * BUFFER + (LATER_BUFFERS if buffer >= 2 else 0) + line * size, size)

    def steps(bits):
        nonlocal frames
        kind = value(bits, tokens.fields, "kind")
        if bits & 1:
            places, (across, down), requests = tokens.places(bits), tokens.line, []
            inside = [(x, y) for _, x, y in places if x < extent[0] and y < extent[1]]
            if inside:
                line = inside[0][1] // down * -(-extent[0] // across) + inside[0][0] // across
                requests = [] if picture.gathered[-1:] == [line] else [write(gone) for gone in picture.touch(line)]
            yield max(len(places), 1), 0, {}, requests
        elif kind == FRAME:
            extent[:] = (value(bits, tokens.fields, name) for name in ("width", "height"))
            yield picture.begin(-(-extent[0] // tokens.line[0]) * -(-extent[1] // tokens.line[1])), 0, {}
            for line in picture.unflagged:
                yield 1, 0, {}, [write(line)]
        elif kind == FRAME_END:
            while picture.gathered:
                yield 1, 0, {}, [write(picture.gathered.pop(0))]
            found = True
            while found:
                found, cycles = picture.take_clear()
                # Without a clear line, the display flips.
                yield cycles, 0, {}, [write(line) for line in found] or [("w", 1, write(0)[2], 1)]
            frames += 1
        else:
            yield 1, 0, {}

    return made.generate(tokens.frames(12), steps)


def brightness(base, seed):
    """Returns vectors of the brightness fetch unit (112): several sets of CLUTs, one and two levels, each calculated on its first use."""
    made = Synthetic(base, "brightness", seed, caches={0: "clut"})
    rng, count, stride = made.random, base.config["replacement"]["entries"], clut_stride(base, made.only)
    sets = min(base.config["brightness"]["sets"], 3)
    known = made.tables[made.only]
    # A full scale of as many steps as a brightness has, so that each step is a whole number.
    full = f"{single_bits(255.0 * 128):08x}"
    cluts = {(number, level): [rng.choice([0, 255, rng.randrange(256)]) for _ in range(count)] for number in range(sets) for level in range(8)}
    address = lambda number, level: CLUTS + (number * 8 + level) * stride  # noqa: E731
    made.tables[made.only] = {name: table for name, table in known.items() if not name.startswith("clut.")}
    made.tables[made.only].update({f"clut.{address(*key)}.{full}": entries for key, entries in cluts.items()})
    fields, out = (made.fields[made.stages[made.only][key][0]] for key in ("inputs", "outputs"))
    entry_bytes, normal_bytes, entry_cycles, latency = (known[name][0] for name in ("entry_bytes", "normal_bytes", "entry_cycles", "latency"))
    tokens, calculated, of = [], set(), {}
    for _ in range(TOKENS // 2):
        if rng.random() < 0.2:
            tokens.append(token(fields, kind=rng.choice([FRAME, OBJECT, POLYGON, FRAME_END]), number=rng.getrandbits(20)))
            continue
        samples, pixels, first, values = rng.randint(1, 2), rng.randint(1, 4), rng.randrange(7), {}
        for lane in range(pixels):
            values.update({f"stamp_{lane}_x": rng.getrandbits(16), f"stamp_{lane}_y": rng.getrandbits(16)})
            share = rng.choice([0, 1, 64, 128]) if samples == 2 else 128
            for sample in range(samples):
                values.update({f"sample_{sample}_level": first + sample, f"sample_{sample}_{lane}_index": rng.randrange(count),
                               f"sample_{sample}_{lane}_share": 128 - share if sample else share})
        tokens.append(token(fields, item=1, stamp_count=pixels, samples=samples, **values))
        of[len(tokens) - 1] = rng.randrange(sets)
    place = iter(range(len(tokens)))

    def rebuild(key):
        """Yields the steps that calculate a level of a set: read, light and write overlap."""
        read = lit = written = 0
        at_once = 32 // entry_bytes
        while written < count:
            requests = [("w", 1, address(*key) + written * entry_bytes, (lit - written) * entry_bytes)] if lit > written else []
            more = min(count - read, at_once)
            requests += [("r", 1, key[1] * VQ_STRIDE + read * normal_bytes, more * normal_bytes)] if more else []
            yield max((read - lit) * entry_cycles, 1), 0, {}, requests, more > 0
            read, lit, written = read + more, read, lit

    def steps(bits):
        number = next(place)
        if not bits & 1:
            result = token(out, **{name: value(bits, fields, name) for name in ("kind", "number")})
            yield 1, latency, {0: result}
            return
        get = lambda name: value(bits, fields, name)  # noqa: E731
        samples, pixels = get("samples"), get("stamp_count")
        levels = [get(f"sample_{sample}_level") for sample in range(samples)]
        for level in levels:
            if (of[number], level) not in calculated:
                yield from rebuild((of[number], level))
                calculated.add((of[number], level))
        values, look_ups = {}, []
        for lane in range(pixels):
            total = 0
            for sample, level in enumerate(levels):
                index = get(f"sample_{sample}_{lane}_index")
                total += get(f"sample_{sample}_{lane}_share") * cluts[of[number], level][index]
                look_ups.append(("l", 0, address(of[number], level) + index * entry_bytes, entry_bytes))
            exact = single_bits(total)
            values.update({f"{lane}_{axis}": get(f"stamp_{lane}_{axis}") for axis in "xy"})
            values[f"{lane}_brightness"] = exact
        yield pixels, latency + pixels - 1, {0: token(out, item=1, count=pixels, **values)}, look_ups, False, latency

    return made.generate(tokens, steps)
