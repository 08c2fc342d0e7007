"""Synthetic vectors by unit. Those of units of the bump-mapping processor and of the texel value generator are here."""

import random

from channel_vectors import SEEDS as CHANNEL_SEEDS
from channel_vectors import channel_vectors
from defer_vectors import identification, reference_buffer, tile_lists
from pixel_vectors import brightness, depth_test, frame_buffer
from recording import replaced, value
from shade_vectors import adder, gate, register_bank, selector_28, selector_53
from synthetic import TOKENS, Synthetic, token
from texel_vectors import step_calculator


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
    return name in ("kind", "number", "width", "height", "bump", "lod", "mapped", "textured", "triangles", "criterion")


def combiner(base, seed):
    """Returns vectors of the combiner (350): products that saturate, and halves."""
    made = Synthetic(base, "combiner", seed)
    names, rng, config = made.stages[made.only], made.random, base.config["combiner"]
    textures, lights = (made.fields[name] for name in names["inputs"])
    out, streams = made.fields[names["outputs"][0]], [[], []]
    component = lambda: rng.choice([0, 0x4000, 0x8000, 0xFFFF, rng.getrandbits(16), rng.getrandbits(15)])  # noqa: E731
    for _ in range(TOKENS // 2):
        colours = [{f"{p}_{c}": component() for p in range(16) for c in ("red", "green", "blue")} for _ in range(2)]
        place = dict(packet_x=16 * rng.getrandbits(8), packet_y=rng.getrandbits(12), packet_mask=rng.choice([0, 0xFFFF, rng.getrandbits(16)]))
        streams[0].append(token(textures, item=1, **place, **colours[0]))
        streams[1].append(token(lights, item=1, **colours[1]))
    latency = made.tables.get(made.only, {}).get("latency", [config["latency"]])[0]

    def step(tokens):
        mask = value(tokens[0], textures, "packet_mask")
        result = token(out, item=1, **{name: value(tokens[0], textures, f"packet_{name}") for name in ("x", "y", "mask")})
        for p in range(16):
            factors = [[value(bits, fields, f"{p}_{c}") for c in ("red", "green", "blue")] for bits, fields in ((tokens[0], textures), (tokens[1], lights))]
            rgb = sum(min(a * b + (1 << 21) >> 22, 255) << 8 * c for c, (a, b) in enumerate(zip(*factors)))
            if mask >> p & 1:
                result = replaced(result, out, f"{p}_rgb", rgb)
        pixels, interval = bin(mask).count("1"), config["initiation_interval"]
        return max(pixels * interval, 1), latency + max(pixels - 1, 0) * interval, {0: result} if mask else {}

    return made.join(streams, lambda: [0, 1], step)


# Generators of vectors by unit, with the machine whose fields they use.
GENERATORS = {
    "gate": gate, "adder": adder, "selector_53": selector_53, "selector_28": selector_28, "combiner": combiner, "register_bank": register_bank,
    "distributor": distributor, "replacement": replacement, "channel": channel_vectors,
    "identification": identification, "tile_lists": tile_lists, "reference_buffer": reference_buffer,
    "depth_test": depth_test, "frame_buffer": frame_buffer, "brightness": brightness,
    "step_calculator": step_calculator,
}
# Numbers of vectors.
SEEDS = {"channel": CHANNEL_SEEDS, "tile_lists": 4}


def vectors(unit, recordings, machine):
    """Returns the synthetic vectors of a unit, if a recording of its machine gives the fields."""
    base = next((r for r in recordings if r.machine == machine), None)
    if base is None or unit not in GENERATORS:
        return []
    return [GENERATORS[unit](base, seed) for seed in range(SEEDS.get(unit, 2))]
