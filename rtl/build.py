"""Builds a test bench for a twin: SystemVerilog and C++ that follow from the fields of the recorded tokens, and Verilator's program."""

import hashlib
import pathlib
import subprocess

from recording import width

HERE = pathlib.Path(__file__).resolve().parent
TARGET = HERE.parent / "target" / "rtl"
LIBRARY = sorted((HERE / "lib").glob("*.sv"))
# Modules of the library that read a token by its fields, so that they exist only for units whose first input is a token of pixels.
OF_PIXELS = {"token_line.sv"}
# Verilator passes ports of more than 64 bits as arrays of words.
LEAST_PORT = 65


def macros(ports):
    """Returns macros for width and FIFO depth of each port, and for first bit and width of each field."""
    lines = []
    for port, fields, depth in ports:
        lines.append(f"`define {port}_W {width(fields)}")
        lines.append(f"`define {port}_DEPTH {depth}")
        for name, first, bits in fields:
            lines.append(f"`define {port}_{name} {first}")
            lines.append(f"`define {port}_{name}_N {bits}")
        # Lanes of a stamp, and the distance between two.
        places = [first for name, first, _ in fields if name in (f"{lane}_x" for lane in range(4))]
        if places:
            lines.append(f"`define {port}_STAMP {len(places)}")
            lines.append(f"`define {port}_STRIDE {places[1] - places[0] if len(places) > 1 else 0}")
            lane = [first + bits for name, first, bits in fields if name.startswith("0_")]
            lines.append(f"`define {port}_LANE {max(lane) - places[0]}")
    return "\n".join(lines) + "\n"


def library(inputs):
    """Returns the library modules for a unit with these inputs."""
    names = {name for name, *_ in inputs[0][0]} if inputs else set()
    return [path for path in LIBRARY if path.name not in OF_PIXELS or names & {"0_x", "mask", "packet_mask"}]


def padded(bits):
    return max(bits, LEAST_PORT)


def top(unit, twin, inputs, outputs, parameters):
    """Returns the module around a twin: FIFOs at its ends. `inputs`, `outputs`: fields, depth and latency of each FIFO."""
    ports, body, pins = ["input wire clk, rst", "input wire [31:0] answered", "output wire start"], [], []
    for i, (fields, depth, latency) in enumerate(inputs):
        w, p = width(fields), padded(width(fields))
        ports += [f"input wire i{i}_reserve, i{i}_push", f"input wire [{p - 1}:0] i{i}_data", f"output wire i{i}_room"]
        body.append(f"wire i{i}_valid, i{i}_pop; wire [{w - 1}:0] i{i};")
        body.append(
            f"fifo #(.W({w}), .DEPTH({depth}), .LATENCY({latency})) in{i} (.clk, .rst, .room(i{i}_room), .reserve(i{i}_reserve), "
            f".push(i{i}_push), .push_data(i{i}_data[{w - 1}:0]), .valid(i{i}_valid), .data(i{i}), .pop(i{i}_pop));"
        )
        pins += [f".in{i}_valid(i{i}_valid)", f".in{i}(i{i})", f".in{i}_pop(i{i}_pop)"]
    for o, (fields, depth, latency) in enumerate(outputs):
        w, p = width(fields), padded(width(fields))
        ports += [f"input wire o{o}_pop", f"input wire [{p - 1}:0] o{o}_pass", f"output wire o{o}_valid, o{o}_push, o{o}_reserve"]
        ports += [f"output wire [{p - 1}:0] o{o}_data"]
        body.append(f"wire o{o}_room; wire [{w - 1}:0] o{o}, o{o}_front;")
        body.append(
            f"fifo #(.W({w}), .DEPTH({depth}), .LATENCY({latency})) out{o} (.clk, .rst, .room(o{o}_room), .reserve(o{o}_reserve), "
            f".push(o{o}_push), .push_data(o{o}), .valid(o{o}_valid), .data(o{o}_front), .pop(o{o}_pop));"
        )
        body.append(f"assign o{o}_data = {{{{{p - w + 1}{{1'b0}}}}, o{o}}};" if p > w else f"assign o{o}_data = o{o};")
        pins += [f".out{o}_room(o{o}_room)", f".out{o}_reserve(o{o}_reserve)", f".out{o}_push(o{o}_push)", f".out{o}(o{o})"]
        if o in twin.passes:
            pins.append(f".pass{o}(o{o}_pass[{w - 1}:0])")
    for k in sorted({*twin.ready, *twin.requests}):
        ports += [f"input wire m{k}_ready", f"output wire m{k}_request", f"output wire [47:0] m{k}_address"]
        if k in twin.ready:
            pins.append(f".mem{k}_ready(m{k}_ready)")
        if k in twin.requests:
            pins += [f".mem{k}_request(m{k}_request)", f".mem{k}_address(m{k}_address)"]
        else:
            body.append(f"assign m{k}_request = 1'b0; assign m{k}_address = 48'd0;")
    if twin.is_answered:
        pins.append(".answered(answered)")
    values = ", ".join(f".{name}({value})" for name, value in parameters.items())
    body.append(f"{unit} #({values}) unit (.clk, .rst, .start, {', '.join(pins)});" if values else f"{unit} unit (.clk, .rst, .start, {', '.join(pins)});")
    return f"module top ({', '.join(ports)});\n    " + "\n    ".join(body) + "\nendmodule\n"


def accessors(twin, inputs, outputs):
    """Returns C++ functions that connect the bench to the ports."""

    def words(fields):
        return -(-width(fields) // 32)

    def port_words(fields):
        return -(-padded(width(fields)) // 32)

    lines = [f"enum {{ INPUTS = {len(inputs)}, OUTPUTS = {len(outputs)}, CLIENTS = {max([*twin.ready, *twin.requests, -1]) + 1} }};"]
    lines += [f"static const size_t in_words[] = {{{', '.join(str(words(f)) for f, *_ in inputs) or '0'}}};"]
    lines += [f"static const size_t out_words[] = {{{', '.join(str(words(f)) for f, *_ in outputs) or '0'}}};"]

    def function(head, cases, default=""):
        return f"static {head} {{\n    switch (n) {{\n" + "\n".join(f"    case {n}: {text}" for n, text in cases) + f"\n    }}\n{default}}}"

    def set_words(port, fields, bits):
        return f"for (int w = 0; w < {port_words(fields)}; w++) top->{port}[w] = {bits} && w < {words(fields)} ? (*{bits})[w] : 0;"

    lines.append(function(
        "void drive_in(Vtop* top, int n, bool reserve, bool push, const Bits* bits)",
        [(i, f"top->i{i}_reserve = reserve; top->i{i}_push = push; {set_words(f'i{i}_data', f, 'bits')} break;") for i, (f, *_) in enumerate(inputs)]))
    lines.append(function("bool lacks_room(Vtop* top, int n)",
        [(i, f"return top->i{i}_reserve && !top->i{i}_room;") for i in range(len(inputs))], "    return false;\n"))
    lines.append(function("void drive_pop(Vtop* top, int n, bool pop)", [(o, f"top->o{o}_pop = pop; break;") for o in range(len(outputs))]))
    lines.append(function("void drive_pass(Vtop* top, int n, const Bits* bits)",
        [(o, f"{set_words(f'o{o}_pass', f, 'bits')} break;") for o, (f, *_) in enumerate(outputs)]))
    for name, port in [("push_out", "push"), ("valid_out", "valid"), ("reserves_out", "reserve")]:
        lines.append(function(f"bool {name}(Vtop* top, int n)", [(o, f"return top->o{o}_{port};") for o in range(len(outputs))], "    return false;\n"))
    fields = [
        (o, "".join(
            f'if (!same(top->o{o}_data, bits, {first}, {bits})) bad += " {name}";\n' for name, first, bits in f) + "break;")
        for o, (f, *_) in enumerate(outputs)
    ]
    lines.append(
        "template <class T> static bool same(const T& data, const Bits& bits, int first, int count) {\n"
        "    for (int b = first; b < first + count; b++)\n"
        "        if ((data[b / 32] >> (b % 32) & 1) != (bits[b / 32] >> (b % 32) & 1)) return false;\n    return true;\n}")
    lines.append(function("std::string compare_out(Vtop* top, int n, const Bits& bits)",
        [(n, text) for n, text in fields], "    return bad;\n").replace("{\n    switch", "{\n    std::string bad;\n    switch", 1))
    clients = sorted({*twin.ready, *twin.requests})
    lines.append(function("void drive_ready(Vtop* top, int n, bool ready)", [(k, f"top->m{k}_ready = ready; break;") for k in clients]))
    lines.append(function("bool request_of(Vtop* top, int n, int64_t& address)",
        [(k, f"address = top->m{k}_address; return top->m{k}_request;") for k in clients], "    return false;\n"))
    return "\n".join(lines) + "\n"


def build(unit, twin, source, inputs, outputs, parameters, files=()):
    """Builds the bench of a twin unless a build of the same sources exists. Returns the program."""
    ports = [(f"IN{i}", fields, depth) for i, (fields, depth, _) in enumerate(inputs)]
    ports += [(f"OUT{o}", fields, depth) for o, (fields, depth, _) in enumerate(outputs)]
    texts = {
        "wires.sv": macros(ports),
        "top.sv": top(unit, twin, inputs, outputs, parameters),
        "ports.h": accessors(twin, inputs, outputs),
        "bench.cpp": (HERE / "bench.cpp").read_text(),
        "unit.sv": source.read_text(),
        **{path.name: path.read_text() for path in library(inputs)},
        **dict(files),
    }
    digest = hashlib.sha256("\0".join(f"{name}\0{text}" for name, text in sorted(texts.items())).encode()).hexdigest()[:16]
    folder = TARGET / "build" / f"{unit}-{digest}"
    program = folder / "obj_dir" / "Vtop"
    if not program.exists():
        folder.mkdir(parents=True, exist_ok=True)
        for name, text in texts.items():
            (folder / name).write_text(text)
        sources = ["wires.sv", *(path.name for path in library(inputs)), "unit.sv", "top.sv"]
        command = ["verilator", "--cc", "--exe", "--build", "-O3", "-CFLAGS", "-O1", "--unroll-count", "1024", "-Wno-fatal", "-Wno-lint", "-Wno-style",
                   "--top-module", "top", *sources, "bench.cpp"]
        made = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
        if made.returncode:
            raise SystemExit(f"{unit}: Verilator failed\n{made.stdout[-3000:]}{made.stderr[-3000:]}")
    return program
