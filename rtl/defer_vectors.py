"""Synthetic vectors of units of the rate-limited renderer."""

from floats import rounded, single_bits
from recording import value
from synthetic import TOKENS, Made, Synthetic, token
from twins import tiles_of

# Sizes of the textures of the synthetic pages: of one tile, of partial tiles at the edges, of several layers.
TEXTURES = [(8, 8), (40, 24), (33, 70), (5, 3)]
FRAME, PAGE, ITEM, END = 0, 1, 2, 3
PASS_BEGIN, PASS_END = 3, 4
DIRECT, EMPTY = 0xFFFE, 0xFFFF
MARKS = 16


def halved(side, times):
    return -(-side // (1 << times))


def page_tables(base):
    """Returns the tables of the synthetic pages."""
    tile, tables = (base.config["tile"]["width"], base.config["tile"]["height"]), {}
    for page, size in enumerate(TEXTURES):
        deepest = next(d for d in range(32) if all(halved(side, d) <= most for side, most in zip(size, tile)))
        layers, first = [], 0
        for halvings in range(deepest, -1, -1):
            width, height = (halved(side, halvings) for side in size)
            pitch, rows = -(-width // tile[0]), -(-height // tile[1])
            layers.append(width | height << 16 | pitch << 32 | rows << 48 | first << 64)
            first += pitch * rows
        tables[f"layers.{page}"] = layers
        tables[f"size.{page}"] = [single_bits(side) for side in size] + [single_bits(1.0 / side) for side in size]
    return tables


def wrapped(s, size, mode):
    """Returns a texture coordinate within the texture, each operation rounded."""
    inverse = rounded(1.0 / size)
    if mode == 0:
        s = rounded(s - rounded(size * (rounded(s * inverse) // 1.0)))
        s = rounded(s + size) if s < 0 else s
        s = rounded(s - size) if s >= size else s
    elif mode == 1:
        s = rounded(s - rounded(2.0 * size * (rounded(0.5 * s * inverse) // 1.0)))
        s = rounded(2.0 * size - s) if s > size else s
    return min(s, float(size)) if s > 0 else 0.0


def tap(place, halvings, side, repeats, offset):
    """Returns the two texels of a sample along an axis."""
    x = rounded(place / (1 << halvings) - offset)
    number = int(x // 1.0)
    has_fraction = x != number
    if repeats:
        first = side - 1 if number < 0 else min(number, side - 1)
        return first, (first + 1) % side if has_fraction else first
    if number < 0 or number >= side - 1:
        return (0 if number < 0 else side - 1,) * 2
    return number, number + has_fraction


def marked(made, cell):
    """Returns page and number of the tiles that a cell needs, by layer (Figures 5A, 5B, corrected)."""
    tables, tile = made.tables[made.only], (made.config["tile"]["width"], made.config["tile"]["height"])
    offset = 0.5 if made.config["defer"]["texel_centre"] == "half" else 0.0
    page, modes, (s, t), depth = cell
    layers = tables[f"layers.{page}"]
    deepest = len(layers) - 1
    coarse = min(int(depth), deepest)
    places = [wrapped(x, size, mode) for x, size, mode in zip((s, t), TEXTURES[page], modes)]
    for layer in [coarse, coarse + 1] if coarse < deepest and depth > coarse else [coarse]:
        sides, pitch, first = [layers[layer] & 0xFFFF, layers[layer] >> 16 & 0xFFFF], layers[layer] >> 32 & 0xFFFF, layers[layer] >> 64
        taps = [tap(place, deepest - layer, side, mode == 0, offset) for place, side, mode in zip(places, sides, modes)]
        (column, right), (row, below) = ([texel // size for texel in pair] for pair, size in zip(taps, tile))
        needed = [(column, row)] + [(right, row)] * (right != column)
        needed += [(right, below)] * (right != column and below != row) + [(column, below)] * (below != row)
        yield [(page, first + r * pitch + c) for c, r in needed]


def random_cells(rng):
    """Returns the cells of a block: page, wrap modes, coordinates and layer depth, most of them near each other."""
    page = rng.randrange(len(TEXTURES))
    centre, depth = [rng.uniform(-2, 3) * side for side in TEXTURES[page]], rng.choice([0.0, 1.0, 2.0, rng.uniform(0, 4)])
    cells = {}
    for i in range(16):
        kind = rng.random()
        if kind < 0.3:
            continue
        if kind < 0.4:
            cells[i] = (DIRECT, (0, 0), (0.0, 0.0), 0.0)
            continue
        place = [rounded(rng.choice([x + rng.uniform(-4, 4), round(x), round(x) + 0.5, 8 * round(x / 8), 8 * round(x / 8) - 0.5])) for x in centre]
        cells[i] = (page, (rng.randrange(3), rng.randrange(3)), place, rng.choice([rounded(depth), round(depth) + 0.0]))
    return cells


def cell_values(prefix, cell):
    """Returns the fields of a cell."""
    page, modes, (s, t), depth = cell
    return {f"{prefix}page": page, f"{prefix}wrap_0": modes[0], f"{prefix}wrap_1": modes[1], f"{prefix}s": single_bits(s), f"{prefix}t": single_bits(t),
            f"{prefix}depth": single_bits(depth)}


def identification(base, seed):
    """Returns vectors of the identification (461): wrapped and mirrored coordinates, samples at the borders of tiles and layers, whole depths."""
    made = Synthetic(base, "identification", seed, page_tables(base))
    fields, out, rng = made.fields["marking"], made.fields["marks"], made.random
    blocks, tokens, centre = {}, [token(fields, kind=PAGE, number=page) for page in range(len(TEXTURES))], [0, 0]
    while len(tokens) < TOKENS // 2:
        if rng.random() < 0.1:
            kind = rng.choice([FRAME, PASS_BEGIN, PASS_END])
            tokens.append(token(fields, kind=kind, **(dict(width=rng.randint(1, 200), height=rng.randint(1, 200)) if kind == FRAME else {})))
            continue
        cells = random_cells(rng)
        if len({tile for cell in cells.values() if cell[0] < DIRECT for layer in marked(made, cell) for tile in layer}) > MARKS:
            continue
        values = {}
        for i in range(16):
            values.update(cell_values(f"{i}_", cells[i]) if i in cells else {f"{i}_page": EMPTY})
        tokens.append(token(fields, kind=ITEM, x=rng.randrange(50), y=rng.randrange(50), mask=sum(1 << i for i in cells), **values))
        blocks[tokens[-1]] = cells
    latency = base.config["engine"]["latency"]

    def steps(bits):
        kind = value(bits, fields, "kind")
        if kind == FRAME:
            centre[:] = value(bits, fields, "width") // 2, value(bits, fields, "height") // 2
        if kind != ITEM:
            yield 1, latency, {} if kind == PASS_BEGIN else {0: token(out, kind=END if kind == PASS_END else kind)}
            return
        pixels, tested = {}, 0
        for _, cell in sorted(blocks[bits].items()):
            for tiles in marked(made, cell) if cell[0] < DIRECT else []:
                tested += 1
                for tile in tiles:
                    pixels[tile] = pixels.get(tile, 0) + 1
        distance = sum((4 * value(bits, fields, axis) + 2 - of) ** 2 for axis, of in zip("xy", centre))
        marks = {}
        for i, ((page, tile), count) in enumerate(pixels.items()):
            marks.update({f"{i}_valid": 1, f"{i}_page": page, f"{i}_tile": tile, f"{i}_pixels": count, f"{i}_distance": distance})
        yield max(tested, 1), latency + max(tested - 1, 0), {0: token(out, kind=ITEM, **marks)} if pixels else {}

    return made.generate(tokens, steps)


class Lists:
    """Model of the tile load lists (136): states of all tiles, and the phases of Figure 4B."""

    def __init__(self, made):
        self.made, self.config, self.mode = made, made.config["engine"], made.config["defer"]
        self.tiles, self.order, self.firsts = tiles_of(made, made.only)
        self.states, self.plan, self.phase, self.pages, self.pictures = ["N"] * len(self.tiles), [], "identified", 0, 0
        self.fields = [made.fields[name] for name in made.stages[made.only]["outputs"]]

    def mark(self, tile):
        if self.states[tile] == "N":
            self.states[tile] = "L"

    def token(self, output, kind, number=None):
        page, tile = self.tiles[number][:2] if number is not None else (0, 0)
        return token(self.fields[output], kind=kind, page=page, tile=tile)

    def word_cycles(self):
        """Returns the cycles of passing over all lists, a word per cycle."""
        return max(-(-self.firsts[self.pages] // self.config["list_rate"]), 1)

    def acquire(self):
        """Plans all tiles in state L. Returns the cycles, and an announcement if a tile will be loaded."""
        for tile in self.order[: self.firsts[self.pages]]:
            if self.states[tile] == "L":
                sources = self.tiles[tile][2]
                self.plan.append((tile, bool(sources) and all(self.states[s] == "E" for s in sources)))
                self.states[tile] = "E"
        given = {0: self.token(0, 0)} if any(not averages for _, averages in self.plan) else {}
        return self.word_cycles(), given

    def end(self):
        """Handles the end of marks."""
        if self.phase == "identified":
            for tile in range(self.firsts[self.pages]) if self.mode["mode"] != "best" else []:
                if self.mode["mode"] == "conventional" or self.tiles[tile][1] == 0:
                    self.mark(tile)
            self.phase = "acquire"
            return self.acquire()
        self.pictures += 1
        cycles, given = (1, {}) if self.pictures == self.mode["pictures_per_view"] else self.acquire()
        if self.plan:
            self.phase = "acquire"
            return cycles, {**given, 2: 1}
        self.phase = "identified"
        return cycles, {0: self.token(0, 2), 2: 0}

    def next(self):
        """Makes a step without a token."""
        if self.plan:
            tile, averages = self.plan.pop(0)
            return {1: self.token(1, int(averages), tile), **({} if averages else {0: self.token(0, 1, tile)})}
        if self.mode["mode"] == "progressive":
            self.phase = "improved"
            return {1: self.token(1, 2)}
        self.phase = "identified"
        return {0: self.token(0, 2), 1: self.token(1, 2), 2: 0}

    def step(self, taken):
        latency, fields = self.config["latency"], self.made.fields["marks"]
        if not taken:
            return 1, latency, self.next()
        (bits,) = taken.values()
        kind, cycles, given = value(bits, fields, "kind"), 1, {}
        if kind == FRAME:
            self.states, self.pictures = ["N" if state == "L" else state for state in self.states], 0
            cycles = self.word_cycles()
        elif kind == PAGE:
            self.pages += 1
        elif kind == ITEM:
            marks = [i for i in range(MARKS) if value(bits, fields, f"{i}_valid")]
            for i in marks:
                self.mark(self.firsts[value(bits, fields, f"{i}_page")] + value(bits, fields, f"{i}_tile"))
            cycles = len(marks)
        else:
            cycles, given = self.end()
        return cycles, latency + (cycles - 1 if kind == END else 0), given


def tile_lists(base, seed):
    """Returns vectors of the tile load lists (136) in all modes: tiles that are averaged, that exist, whose sources follow, and views that end."""
    made = Synthetic(base, "tile-lists", seed, page_tables(base))
    made.config = {**base.config, "defer": {**base.config["defer"], "mode": ["best", "progressive", "conventional", "progressive"][seed],
                                            "pictures_per_view": 2 if seed == 3 else 0}}
    lists, fields, rng = Lists(made), made.fields["marks"], made.random
    streams = [[token(fields, kind=PAGE) for _ in TEXTURES[:-1]], []]

    def marks(known):
        tiles = range(lists.firsts[known])
        chosen = rng.sample(tiles, min(rng.randint(1, MARKS), len(tiles)))
        values = {}
        for i, tile in enumerate(chosen):
            values.update({f"{i}_valid": 1, f"{i}_page": lists.tiles[tile][0], f"{i}_tile": lists.tiles[tile][1], f"{i}_pixels": 1})
        return token(fields, kind=ITEM, **values)

    for frame in range(12):
        streams[0].append(token(fields, kind=FRAME))
        # A page that a later frame sets up.
        streams[0] += [token(fields, kind=PAGE)] * (frame == 6)
        known = len(TEXTURES) - (frame < 6)
        streams[0] += [marks(known) for _ in range(rng.randrange(3))] if made.config["defer"]["mode"] == "best" else []
        streams[0].append(token(fields, kind=END))
        # A frame takes as many pictures as it needs, so these marks may belong to any frame: they leave out the page that comes late.
        for _ in range(3):
            streams[1] += [marks(len(TEXTURES) - 1) for _ in range(rng.randrange(3))] + [token(fields, kind=END)]
    inputs = {"identified": [0], "acquire": [], "improved": [1]}
    return made.join(streams, lambda: inputs[lists.phase], lists.step)


def reference_buffer(base, seed):
    """Returns vectors of the reference buffer (126) in both kinds of passes: blocks written again, empty blocks, frames of other sizes, few flags."""
    made = Synthetic(base, "reference-buffer", seed)
    made.config = {**base.config, "defer": {**base.config["defer"], "mode": ["best", "progressive"][seed]},
                   "engine": {**base.config["engine"], "flags": [131_072, 7][seed], "flags_per_cycle": [64, 3][seed]}}
    rng, names = made.random, made.stages[made.only]
    fields, out = made.fields[names["inputs"][0]], made.fields[names["outputs"][0]]
    streams, lanes = [[], []], sum(name.endswith("_coefficient_1") for name, *_ in fields)
    for number in range(6):
        width, height = rng.randint(1, 23), rng.randint(1, 23)
        streams[0].append(token(fields, kind=FRAME, number=number, width=width, height=height))
        streams[0] += [token(fields, kind=PAGE, number=number)] * (number % 2)
        for _ in range(rng.randrange(40)):
            # A token of cells of one block.
            x, y = (4 * rng.randrange(-(-side // 4)) for side in (width, height))
            places = [(x + c, y + r) for r in range(4) for c in range(4) if x + c < width and y + r < height]
            values = {}
            chosen = rng.sample(places, min(rng.randint(1, lanes), len(places)))
            for i, (column, row) in enumerate(chosen):
                cell = (rng.choice([DIRECT, 0, 1]), (1, 2), (rng.uniform(-9, 9), rng.uniform(-9, 9)), rng.uniform(0, 3))
                values.update({f"{i}_x": column, f"{i}_y": row, f"{i}_coefficient_1": rng.getrandbits(16), **cell_values(f"{i}_", cell)})
            streams[0].append(token(fields, kind=ITEM, count=len(chosen), **values))
        streams[0].append(token(fields, kind=END))
        streams[1] += [1] * rng.randrange(3) + [0]
    size = 16 * base.number(made.only, "cell_bytes")
    buffer = Buffer(made, fields, out, size)
    inputs = dict(fill=[0], wait=[1])
    return made.execute(streams, lambda: inputs.get(buffer.phase, []), buffer.step)


class Buffer:
    """Model of the reference buffer (126)."""

    def __init__(self, made, fields, out, size):
        self.is_best, self.config, self.fields, self.out, self.size = made.config["defer"]["mode"] == "best", made.config["engine"], fields, out, size
        self.phase, self.cells, self.lines, self.columns, self.rows, self.block = "fill", {}, [], 0, 0, 0
        self.clear, self.unflagged = set(), []
        self.parts = [name[2:] for name, *_ in fields if name.startswith("0_") and name[2:] not in "xy"]

    def write(self, block):
        return ("w", 1, block * self.size, self.size)

    def begin(self, numbers):
        """Begins a frame. Returns the cycles."""
        self.cells, self.lines = {}, []
        self.columns, self.rows = -(-numbers["width"] // 4), -(-numbers["height"] // 4)
        blocks, flagged = list(range(self.columns * self.rows)), self.config["flags"] if self.config["clear_flags"] else 0
        self.clear, self.unflagged = set(blocks[:flagged]), blocks[flagged:]
        self.phase = "clear" if self.unflagged else "fill"
        return max(-(-len(self.clear) // self.config["flags_per_cycle"]), 1)

    def put(self, bits):
        """Stores the cells of a token. Returns the requests."""
        count = value(bits, self.fields, "count")
        for i in range(count):
            x, y = (value(bits, self.fields, f"{i}_{axis}") for axis in "xy")
            block = y // 4 * self.columns + x // 4
            self.cells[block, y % 4 * 4 + x % 4] = {part: value(bits, self.fields, f"{i}_{part}") for part in self.parts}
        self.clear.discard(block)
        self.lines = [line for line in self.lines if line != block] + [block]
        return count, [self.write(self.lines.pop(0))] if len(self.lines) > self.config["write_lines"] else []

    def flush(self):
        requests = [self.write(self.lines.pop(0))] if self.lines else []
        self.phase = "flush" if self.lines else "identify" if self.is_best else "begin"
        return {0: token(self.out, kind=PASS_END)} if self.phase == "begin" else {}, requests

    def read(self):
        """Reads the next block of a pass."""
        output = int(self.phase == "colour")
        if self.block == self.columns * self.rows:
            self.phase = "wait" if output else "begin"
            self.block = 0
            return {output: token(self.out, kind=PASS_END)}, [], 1
        values, mask, block = {}, 0, self.block
        for i in range(16):
            cell = self.cells.get((block, i), dict(page=EMPTY))
            values.update({f"{i}_{part}": number for part, number in cell.items()})
            mask |= (cell["page"] != EMPTY) << i
        bits = token(self.out, kind=ITEM, x=block % self.columns, y=block // self.columns, mask=mask, **values)
        self.block += 1
        requests = [] if block in self.clear else [("r", 0, block * self.size, self.size)]
        return {output: bits} if output or mask else {}, requests, -(-16 // self.config["scan_rate"])

    def step(self, taken):
        latency, given, requests, cycles = self.config["latency"], {}, [], 1
        kind = value(taken[0], self.fields, "kind") if 0 in taken else None
        if kind == ITEM:
            cycles, requests = self.put(taken[0])
        elif kind == END or self.phase == "flush":
            given, requests = self.flush()
        elif 0 in taken:
            numbers = {name: value(taken[0], self.fields, name) for name in ("number", "width", "height")}
            if kind == FRAME:
                cycles = self.begin(numbers)
            given = dict.fromkeys((0, 1), token(self.out, kind=kind, **numbers))
        elif 1 in taken:
            self.phase = "begin" if taken[1] else "fill"
        elif self.phase == "clear":
            requests = [self.write(self.unflagged.pop(0))]
            self.phase = "clear" if self.unflagged else "fill"
        elif self.phase == "begin":
            self.phase = "colour"
            given = {1: token(self.out, kind=PASS_BEGIN)}
        else:
            given, requests, cycles = self.read()
        return Made(cycles, latency, given, requests)
