"""The twins: for each unit its file, the stages that it is compared with, and its parameters."""

import functools

from channel_vectors import channel, channel_tokens
from geometry import geometry, geometry_tokens
from floats import single_of
from recording import replaced, value, width


class Twin:
    """A twin of a unit.

    `stages` lists machine and stage. `parameters` computes the parameters of the module from a recording and the number of the stage.
    `passes` lists outputs whose values are computed in floating point: the bench passes them in, and the twin decides time and order.
    `ready` lists memory clients whose credits the unit needs, `requests` clients whose requests are compared, `caches` the cache of a
    client. `blocks` returns true if a step without a token keeps its unit until its answers. `files` returns files that the module reads.
    `rewrite` changes the fields and the bits of the tokens. `writes` gives the writes of a client a port of their own. `needs` gives the values of
    machine parameters for which the twin holds: a value, or text and test of the value and the whole configuration. `is_recorded` is false
    for a twin of no recorded stage, which has synthetic vectors only.
    """

    def __init__(self, stages, parameters, passes=(), ready=(), requests=(), is_answered=False, files=None, caches=None, blocks=None, rewrite=None,
                 writes=None, needs=None, is_recorded=True):
        self.stages, self.parameters, self.passes = stages, parameters, passes
        self.caches, self.rewrite, self.writes = caches or {}, rewrite, writes or {}
        self.ready, self.requests, self.is_answered, self.files = ready, requests, is_answered, files
        self.blocks = blocks or (lambda steps, number: False)
        self.needs, self.is_recorded = needs or {}, is_recorded

    def unfit(self, recording):
        """Returns the first parameter of a recording for which the twin does not hold, in words; `None` if it holds."""
        for key, needed in self.needs.items():
            found = functools.reduce(dict.__getitem__, key.split("."), recording.config)
            text, holds = needed if isinstance(needed, tuple) else (needed, lambda found, _, needed=needed: found == needed)
            if not holds(found, recording.config):
                return f"{key} is {shown(found)}, and the twin holds for {shown(text)} only"
        return None

    def limits(self):
        """Returns the parameters for which the twin holds, in words."""
        return [(key, shown(needed[0] if isinstance(needed, tuple) else needed)) for key, needed in self.needs.items()]

    def is_idle(self, recording):
        """Returns true if no stage of the twin makes a step in the recording."""
        names = {stage for machine, stage in self.stages if machine == recording.machine}
        return self.is_recorded and not any(recording.stages[number]["name"] in names for number in recording.steps)


def shown(needed):
    """Returns a value of a parameter as `--set` spells it."""
    return str(needed).lower() if isinstance(needed, bool) else str(needed)


def circuit(name):
    """Returns the parameters of a circuit of the figure shading device."""

    def parameters(recording, stage):
        config = recording.config[name]
        latency = recording.tables.get(stage, {}).get("latency", [config.get("latency")])[0]
        return dict(INTERVAL=config["initiation_interval"], LATENCY=latency)

    return parameters


def flags(config):
    """Returns the parameters of the flags of clear lines."""
    return dict(LIMIT=config["flags"] if config["clear_flags"] else 0, PER_CYCLE=config["flags_per_cycle"])


def frame_buffer(recording, stage):
    """Returns the parameters of a frame buffer."""
    config, display = recording.config["frame_buffer"], recording.config["display"]
    inputs = recording.stages[stage]["inputs"]
    packets = any(name == "mask" for name, *_ in recording.fields[inputs[0]])
    return dict(flags(config), PACKETS=int(packets), LINES=config["write_lines"], LINE_BYTES=16 * config["pixel_bytes"], BUFFERS=display["buffers"])


def depth_test(recording, stage):
    """Returns the parameters of a depth test."""
    config, fields = recording.config["depth"], recording.fields[recording.stages[stage]["inputs"][0]]
    packets = any(name == "packet_mask" for name, *_ in fields)
    bits = next(bits for name, _, bits in fields if name == "0_z")
    return dict(flags(config), PACKETS=int(packets), Z=bits, LATENCY=recording.number(stage, "latency"), LINES=config["write_lines"],
                LINE_BYTES=16 * (2 if bits <= 16 else 4), BASE="64'h10002000")


def numbers(**names):
    """Returns a function that computes parameters from the tables of a unit."""

    def parameters(recording, stage):
        return {parameter: recording.number(stage, name) for parameter, name in names.items()}

    return parameters


def replacement(recording, stage):
    """Returns the parameters of the normal-vector replacement unit."""
    config = recording.config["replacement"]
    size = config["entries"] * recording.number(stage, "entry_bytes")
    loads = -(-size // config["load_bytes"])
    return dict(LANES=config["lanes"], ENTRIES=config["entries"], LATENCY=recording.number(stage, "latency"), LOAD_BYTES=config["load_bytes"],
                LOADS=loads, BASE=VQ_TABLES, STRIDE=VQ_STRIDE)


def reference_normals(recording, stage):
    """Returns the VQ tables as rows of all lanes, level by level."""
    config, rows = recording.config["replacement"], []
    lanes = config["lanes"]
    for level in range(8):
        normals = recording.tables[stage][f"normals.{level}"]
        for first in range(0, len(normals), lanes):
            rows.append("".join(f"{normal:012x}" for normal in reversed(normals[first : first + lanes])))
    return {"tables.hex": "\n".join(rows) + "\n"}


def packed(entries):
    """Returns numbers of 16 bits side by side, the first lowest."""
    return f"{16 * len(entries)}'h" + "".join(f"{entry:04x}" for entry in reversed(entries))


def rasterizer(recording, stage):
    """Returns the parameters of the rasterizer."""
    return dict(numbers(LATENCY="latency", PACE="pace")(recording, stage), SET_UP=packed(recording.tables[stage]["set_up"]))


def normal_mapping(recording, stage):
    """Returns the parameters of the normal-vector mapping unit."""
    pace = recording.tables[stage]["pace"]
    return dict(numbers(LATENCY="latency", AFTER="after")(recording, stage), BARE=pace[0], PACE=packed(pace))


def interpolation(recording, stage):
    """Returns the parameters of the brightness interpolation circuit (21)."""
    return dict(circuit("interpolation")(recording, stage), SET_UP=recording.number(stage, "set_up"))


def normal_interpolation(recording, stage):
    """Returns the parameters of the normal-interpolation brightness circuit (50)."""
    names = dict(SET_UP="set_up", FIXED="fixed_latency", SUM="sum_latency", PRODUCTS="inner_products", NORMALISE="normalise")
    return dict(numbers(**names)(recording, stage), MULTIPLY=recording.config["operators"]["multiply"]["latency"])


def divider(recording, stage):
    """Returns the parameters of the divider."""
    names = dict(LATENCY="latency", INTERVAL="interval", PER_POINT="per_point", PRODUCT="product", PRODUCTS="products")
    return dict(numbers(**names)(recording, stage), COUNT=recording.config["divider"]["count"])


def step_calculator(recording, stage):
    """Returns the parameters of the step calculator."""
    names = dict(LATENCY="latency", DECISION="decision", QUOTIENT="quotient", ROOT="root", FIRST="first", NEXT="next")
    return dict(numbers(**names)(recording, stage), MIN_SPAN=recording.config["texel"]["min_span"], CRITERION=f"64'h{recording.number(stage, 'criterion'):x}")


def clut_stride(recording, stage):
    """Returns the bytes between two levels of a set of CLUTs."""
    size = recording.config["replacement"]["entries"] * recording.number(stage, "entry_bytes")
    return -(-size // 64) * 64


def brightness(recording, stage):
    """Returns the parameters of the brightness fetch unit."""
    names = dict(LATENCY="latency", ENTRY_CYCLES="entry_cycles", NORMAL_BYTES="normal_bytes")
    config = recording.config
    return dict(numbers(**names)(recording, stage), ENTRIES=config["replacement"]["entries"], SETS=config["brightness"]["sets"],
                STRIDE=clut_stride(recording, stage), BATCH=32 // recording.number(stage, "entry_bytes"), CLUTS=CLUTS, VQ_STRIDE=VQ_STRIDE)


def cluts(recording, stage):
    """Returns address, full scale and entries of each calculated level of a set."""
    for name, entries in recording.tables[stage].items():
        if name.startswith("clut."):
            _, address, full = name.split(".")
            yield int(address), single_of(int(full, 16)), entries


def clut_contents(recording, stage):
    """Returns the entries of all sets and levels."""
    size = recording.config["replacement"]["entries"]
    contents = [0] * (recording.config["brightness"]["sets"] * 8 * size)
    for address, _, entries in cluts(recording, stage):
        first = (address - CLUTS) // clut_stride(recording, stage) * size
        contents[first : first + len(entries)] = entries
    return {"clut.hex": "\n".join(f"{entry:02x}" for entry in contents) + "\n"}


def brightness_tokens(recording, stage, inputs, outputs, tokens):
    """Adds the number of the set to each input token, and converts each brightness to steps of full scale."""
    stride, full_scale = clut_stride(recording, stage), {}
    for address, full, _ in cluts(recording, stage):
        full_scale[(address - CLUTS) // stride // 8] = full
    (fields, depth, latency), (out, *_) = inputs[0], outputs[0]
    first = width(fields)
    sets = []
    for step in recording.steps[stage]:
        look_ups = [address for kind, _, address, _ in step["requests"] if kind == "l"]
        if step["given"]:
            sets.append((look_ups[0] - CLUTS) // stride // 8 if look_ups else 0)
    for index, number in enumerate(sets):
        tokens["in"][0][index] |= number << first
        bits = tokens["out"][0][index]
        for lane in range(4 if bits & 1 else 0):
            name = f"{lane}_brightness"
            exact = single_of(value(bits, out, name))
            steps = exact / full_scale[number] * 255 * 128 if exact else 0.0
            assert abs(steps - round(steps)) < 0.01, f"{steps} is no whole number of steps"
            bits = replaced(bits, out, name, round(steps))
        tokens["out"][0][index] = bits
    return [([*fields, ("set", first, 8)], depth, latency)], outputs


def pages_of(recording, stage):
    """Returns size and reciprocals, and the layers of each page: width, height, tile pitch (138), rows and tile base (140)."""
    tables = recording.tables.get(stage, {})
    for number in range(sum(name.startswith("size.") for name in tables)):
        layers = [(*(layer >> 16 * i & 0xFFFF for i in range(4)), layer >> 64) for layer in tables[f"layers.{number}"]]
        yield tables[f"size.{number}"], layers


def lines_of(digits, rows):
    """Returns the contents of a file for `$readmemh`."""
    return "".join(f"{row:0{digits}x}\n" for row in rows)


MOST_LAYERS = 16


def identification(recording, stage):
    """Returns the parameters of the identification of tiles (461)."""
    config, tile = recording.config["engine"], recording.config["tile"]
    return dict(LATENCY=config["latency"], PAGES=max(len(list(pages_of(recording, stage))), 1), LAYERS=MOST_LAYERS,
                ACROSS=tile["width"].bit_length() - 1, DOWN=tile["height"].bit_length() - 1,
                HALF=int(recording.config["defer"]["texel_centre"] == "half"))


def page_files(recording, stage):
    """Returns the set-up registers of the identification of tiles (461)."""
    pages, rows = [], []
    for sizes, layers in pages_of(recording, stage):
        pages.append(sum(bits << 32 * i for i, bits in enumerate(sizes)) | len(layers) - 1 << 128)
        layers = [sum(side << 16 * i for i, side in enumerate(layer)) for layer in layers]
        rows += layers + [0] * (MOST_LAYERS - len(layers))
    return {"pages.hex": lines_of(34, pages), "layers.hex": lines_of(24, rows)}


def reference_buffer(recording, stage):
    """Returns the parameters of the reference buffer (126)."""
    config = recording.config["engine"]
    return dict(flags(config), LATENCY=config["latency"], LINES=config["write_lines"], SCAN=config["scan_rate"],
                CELL_BYTES=recording.number(stage, "cell_bytes"), BEST=int(recording.config["defer"]["mode"] == "best"))


def tiles_of(recording, stage):
    """Returns the tiles of all pages, numbered through: page, tile, and the places of its sources. Also returns the order of Figure 6, and the first
    tile of each page and of the next."""
    tiles, order, firsts = [], [], [0]
    for page, (_, layers) in enumerate(pages_of(recording, stage)):
        first = firsts[-1]
        for layer, finer in zip(layers, [*layers[1:], None]):
            _, _, pitch, rows, base = layer
            for number in range(pitch * rows):
                row, column = divmod(number, pitch)
                sources = [(r, c) for r in (2 * row, 2 * row + 1) for c in (2 * column, 2 * column + 1)] if finer else []
                tiles.append((page, base + number, [first + finer[4] + r * finer[2] + c for r, c in sources if r < finer[3] and c < finer[2]]))
        order += [first + base + number for _, _, pitch, rows, base in reversed(layers) for number in range(pitch * rows)]
        firsts.append(len(tiles))
    return tiles, order, firsts


def tile_lists(recording, stage):
    """Returns the parameters of the tile load lists (136)."""
    config, mode = recording.config["engine"], recording.config["defer"]
    tiles, _, firsts = tiles_of(recording, stage)
    return dict(LATENCY=config["latency"], RATE=config["list_rate"], MODE=["best", "progressive", "conventional"].index(mode["mode"]),
                PICTURES=mode["pictures_per_view"], TILES=max(len(tiles), 1), PAGES=len(firsts) - 1)


def list_files(recording, stage):
    """Returns the set-up registers of the tile load lists (136)."""
    tiles, order, firsts = tiles_of(recording, stage)
    packed_tiles = [page | tile << 16 | sum((sources[i] if i < len(sources) else 0xFFFF) << 48 + 16 * i for i in range(4)) for page, tile, sources in tiles]
    return {"tiles.hex": lines_of(28, packed_tiles), "order.hex": lines_of(4, order), "firsts.hex": lines_of(4, firsts)}


# Parameters for which the twins of the replacement and the brightness fetch unit hold.
STAMPS = {"rasterizer.stamp": 4, "normal_mapping.filter_at": "normal", "brightness.levels": 2, "replacement.codebook": "fixed"}
ROWS = ("powers of two that are not below replacement.lanes",
        lambda entries, config: isinstance(entries, int) and entries.bit_count() == 1 and entries % config["replacement"]["lanes"] == 0)

# Tiles that a scan tests at once, because Verilator does not unroll larger loops of this body. Banks of a channel, by the bits of a burst.
UP_TO_64 = ("at most 64", lambda number, _: number <= 64)

# Address of the VQ tables (121) in memory (120), and the distance between two levels.
VQ_TABLES, VQ_STRIDE = 0, 512 << 10
# Address of the CLUTs (122).
CLUTS = 4 << 20


TWINS = {
    "register_bank": Twin([("shade", "registers")], lambda *_: {}),
    "brightness_interpolation": Twin([("shade", "interpolation")], interpolation, passes=[0, 1]),
    "normal_interpolation": Twin([("shade", "normal-interpolation")], normal_interpolation, passes=[0],
                                 needs={"normal_interpolation.power": "iteration", "normal_interpolation.pipelined": False}),
    "divider": Twin([("texel", "divider")], divider, passes=[0]),
    "step_calculator": Twin([("texel", "step-calculator")], step_calculator, passes=[0, 1], needs={"texel.method": "adaptive"}),
    "mip_map_selector": Twin([("texel", "mip-map-selector")], lambda recording, _: dict(LATENCY=recording.config["mip"]["latency"]), passes=[0]),
    "combiner": Twin([("texel", "combiner")], circuit("combiner"), needs={"combiner.mode": "replace"}),
    "distributor": Twin([("bump", "distributor")], lambda *_: {}),
    "frame_buffer": Twin([("bump", "frame-buffer"), ("shade", "frame-memory"), ("texel", "pixel-value-buffer")], frame_buffer, ready=[0, 1],
                         requests=[0, 1]),
    "brightness": Twin([("bump", "brightness")], brightness, ready=[0, 1], requests=[1, 2], is_answered=True, files=clut_contents,
                       caches={0: "clut"}, blocks=lambda steps, number: any(kind == "r" for kind, *_ in steps[number]["requests"]),
                       rewrite=brightness_tokens, writes={1: 2},
                       needs={**STAMPS, "replacement.entries": ROWS, "brightness.source": "clut", "brightness.components": "combined",
                              "brightness.bits": 8, "brightness.samples_per_cycle": 2}),
    "replacement": Twin([("bump", "replacement")], replacement, ready=[0], requests=[0], is_answered=True, files=reference_normals,
                        blocks=lambda steps, number: number + 1 == len(steps) or not steps[number + 1]["requests"],
                        needs={**STAMPS, "replacement.entries": ROWS, "replacement.pipelined": False, "replacement.resident_tables": 2,
                               "replacement.vq_bias": 0, "normal_mapping.normal_bits": 16}),
    "depth_test": Twin([("bump", "depth-test"), ("shade", "depth-test"), ("texel", "depth-test")], depth_test, ready=[0, 1], requests=[1],
                       is_answered=True, caches={0: "depth"}),
    "geometry": Twin([("bump", "geometry")], geometry, passes=[0], rewrite=geometry_tokens),
    "rasterizer": Twin([("bump", "rasterizer")], rasterizer, passes=[0]),
    "normal_mapping": Twin([("bump", "normal-mapping")], normal_mapping, passes=[0], ready=[0], is_answered=True,
                           caches={0: "normal_map"}),
    "graphics": Twin([("bump", "graphics")], numbers(LATENCY="latency", AFTER="after"), passes=[0], ready=[0], is_answered=True,
                     caches={0: "color_texture"}, needs={"graphics.draw": "streamed"}),
    "channel": Twin([("bump", "channel")], channel, rewrite=channel_tokens, is_recorded=False, needs={"memory.graphics.banks": UP_TO_64}),
    "reference_buffer": Twin([("defer", "reference-buffer")], reference_buffer, ready=[0, 1], requests=[0, 1], is_answered=True),
    "identification": Twin([("defer", "identification")], identification, files=page_files, needs={"engine.scan_rate": 1}),
    "tile_lists": Twin([("defer", "tile-lists")], tile_lists, files=list_files,
                       needs={"tile.order": "listed", "defer.left_at_tile": [], "defer.left_at_ms": [], "engine.list_rate": UP_TO_64}),
    "gate": Twin([("shade", "gate")], circuit("gate")),
    "adder": Twin([("shade", "adder")], circuit("adder")),
    "selector_53": Twin([("shade", "selector-53")], circuit("selector_53")),
    "selector_28": Twin([("shade", "selector-28")], circuit("selector_28")),
}
