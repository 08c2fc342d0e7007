"""Builds a test bench for a twin: SystemVerilog and C++ that follow from the fields of the recorded tokens, and Verilator's program."""

import functools
import hashlib
import pathlib
import subprocess
import tempfile
import threading

from recording import width

HERE = pathlib.Path(__file__).resolve().parent
TARGET = HERE.parent / "target" / "rtl"
LIBRARY = sorted((HERE / "lib").glob("*.sv"))
# Modules of the library that read a token by its fields, so that they exist only for units whose first input is a token of pixels.
OF_PIXELS = {"token_line.sv"}
# Options of the C++ compiler: a twin runs for less time than a compiler optimizes it.
CFLAGS = ["-O1", "-w", "-fcf-protection=none", "-DVM_COVERAGE=0", "-DVM_SC=0", "-DVM_TRACE=0", "-DVM_TRACE_FST=0", "-DVM_TRACE_VCD=0"]
# Macros of the C++ compiler for waves.
TRACES = ["VM_TRACE", "VM_TRACE_FST"]
# Guards of files that are built once.
LOCK, LOCKS = threading.Lock(), {}
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


def top(unit, twin, inputs, outputs, parameters, more_ports):
    """Returns the module around a twin: FIFOs at its ends. `inputs`, `outputs`: fields, depth and latency of each FIFO."""
    ports, body, pins = ["input wire clk, rst", "input wire [31:0] answered_0", "output wire start_0", *more_ports], [], []
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
        pins.append(".answered(answered_0)")
    values = ", ".join(f".{name}({value})" for name, value in parameters.items())
    body.append(f"{unit} #({values}) unit (.clk, .rst, .start(start_0), {', '.join(pins)});" if values else f"{unit} unit (.clk, .rst, .start(start_0), {', '.join(pins)});")
    return f"module top ({', '.join(ports)});\n    " + "\n    ".join(body) + "\nendmodule\n"


def model_ports(outputs, units=1):
    """Returns the ports that show the model in the waves."""
    ports = [f"input wire model_start_{u}" for u in range(units)]
    for o, (fields, *_) in enumerate(outputs):
        ports += [f"input wire model_push_{o}", f"input wire [{padded(width(fields)) - 1}:0] model_data_{o}"]
    return ports


def accessors(inputs, outputs, clients, units=1, nexts=(), waves=False):
    """Returns C++ functions that connect the bench to the ports. `nexts` lists outputs that need the token that they deliver next."""

    def words(fields):
        return -(-width(fields) // 32)

    def port_words(fields):
        return -(-padded(width(fields)) // 32)

    lines = [HEAD.format(units=units, inputs=len(inputs), outputs=len(outputs), clients=max([*clients, -1]) + 1,
                         in_words=", ".join(str(words(f)) for f, *_ in inputs) or "0", out_words=", ".join(str(words(f)) for f, *_ in outputs) or "0")]

    def function(head, cases, default=""):
        lines.append(f"{head} {{\n    switch (n) {{\n" + "\n".join(f"    case {n}: {text}" for n, text in cases) + f"\n    }}\n{default}}}")

    def set_words(port, fields, bits):
        return f"for (int w = 0; w < {port_words(fields)}; w++) top.{port}[w] = {bits} && w < {words(fields)} ? (*{bits})[w] : 0;"

    function("void drive_in(int n, bool reserve, bool push, const Bits* bits)",
        [(i, f"top.i{i}_reserve = reserve; top.i{i}_push = push; {set_words(f'i{i}_data', f, 'bits')} break;") for i, (f, *_) in enumerate(inputs)])
    function("bool lacks_room(int n)", [(i, f"return top.i{i}_reserve && !top.i{i}_room;") for i in range(len(inputs))], "    return false;\n")
    function("void drive_pop(int n, bool pop)", [(o, f"top.o{o}_pop = pop; break;") for o in range(len(outputs))])
    function("void drive_pass(int n, const Bits* bits)", [(o, f"{set_words(f'o{o}_pass', f, 'bits')} break;") for o, (f, *_) in enumerate(outputs)])
    function("void drive_next(int n, const Bits* bits)", [(o, f"{set_words(f'o{o}_next', outputs[o][0], 'bits')} break;") for o in nexts])
    function("void drive_answered(int n, uint32_t steps)", [(u, f"top.answered_{u} = steps; break;") for u in range(units)])
    function("bool starts(int n)", [(u, f"return top.start_{u};") for u in range(units)], "    return false;\n")
    for name, port in [("push_out", "push"), ("valid_out", "valid"), ("reserves_out", "reserve")]:
        function(f"bool {name}(int n)", [(o, f"return top.o{o}_{port};") for o in range(len(outputs))], "    return false;\n")
    for o, (f, *_) in enumerate(outputs):
        lines.append(f"static const Field fields_{o}[] = {{{', '.join(f'{{{chr(34)}{name}{chr(34)}, {first}, {bits}}}' for name, first, bits in f)}}};")
    function("std::string compare_out(int n, const Bits& bits)",
        [(o, f"return differing(top.o{o}_data, bits, {words(f)}, fields_{o});") for o, (f, *_) in enumerate(outputs)], "    return std::string();\n")
    function("void drive_ready(int n, bool ready)", [(k, f"top.m{k}_ready = ready; break;") for k in clients])
    function("bool request_of(int n, int64_t& address)", [(k, f"address = top.m{k}_address; return top.m{k}_request;") for k in clients],
        "    return false;\n")
    if waves:
        function("void drive_model_start(int n, bool start)", [(u, f"top.model_start_{u} = start; break;") for u in range(units)])
        function("void drive_model_push(int n, bool push, const Bits* bits)",
            [(o, f"top.model_push_{o} = push; if (bits) {set_words(f'model_data_{o}', f, 'bits')} break;") for o, (f, *_) in enumerate(outputs)])
    lines.append(WAVES if waves else NO_WAVES)
    return "\n".join(lines) + "\n"


NO_WAVES = """void open_waves(const char*) {}
void drive_model_start(int, bool) {}
void drive_model_push(int, bool, const Bits*) {}
void dump_waves(int64_t) {}
void close_waves() {}"""
# Half a cycle after the clock edge, the signals have settled.
WAVES = """#include "verilated_fst_c.h"
static VerilatedFstC& file = *new VerilatedFstC;
void open_waves(const char* path) {
    context.traceEverOn(true);
    top.trace(&file, 99);
    file.open(path);
}
void dump_waves(int64_t cycle) { file.dump(uint64_t(cycle)); }
void close_waves() { file.close(); }"""
# C++ that is equal for each twin. Tokens are compared by words first, because most are equal.
HEAD = """const int UNITS = {units}, INPUTS = {inputs}, OUTPUTS = {outputs}, CLIENTS = {clients};
const size_t in_words[] = {{{in_words}}}, out_words[] = {{{out_words}}};
static VerilatedContext& context = *new VerilatedContext;
static Vtop& top = *new Vtop(&context);
void reset(bool active) {{ top.rst = active; }}
void clock_edge() {{
    top.clk = 1;
    top.eval();
    top.clk = 0;
}}
void settle() {{ top.eval(); }}
struct Field {{
    const char* name;
    int first, bits;
}};
template <class T, size_t N> static std::string differing(const T& data, const Bits& expected, size_t words, const Field (&fields)[N]) {{
    std::string names;
    bool same = true;
    for (size_t w = 0; w < words; w++) same &= data[w] == expected[w];
    if (same) return names;
    for (const Field& field : fields)
        for (int b = field.first; b < field.first + field.bits; b++)
            if ((data[b / 32] >> (b % 32) & 1) != (expected[b / 32] >> (b % 32) & 1)) {{
                names += std::string(" ") + field.name;
                break;
            }}
    return names;
}}"""


def once(program, make):
    """Calls `make` with a temporary folder unless a file exists, in one thread at a time, and moves the made file to its place."""
    with LOCK:
        lock = LOCKS.setdefault(program, threading.Lock())
    with lock:
        if not program.exists():
            program.parent.mkdir(parents=True, exist_ok=True)
            with tempfile.TemporaryDirectory(dir=program.parent) as folder:
                make(pathlib.Path(folder)).rename(program)
    return program


def run(command, folder, what):
    """Runs a tool, or ends with its messages."""
    made = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    if made.returncode:
        raise SystemExit(f"{what} failed\n{made.stdout[-3000:]}{made.stderr[-3000:]}")
    return made.stdout


@functools.cache
def verilator():
    """Returns Verilator's include folder, and a digest of its version and of the shared parts of the bench."""
    folder = pathlib.Path(run(["verilator", "--getenv", "VERILATOR_ROOT"], HERE, "verilator").strip()) / "include"
    shared = [run([tool, "--version"], HERE, tool) for tool in ("verilator", "g++")] + [(HERE / name).read_text() for name in ("bench.h", "bench.cpp")]
    return folder, digest_of("\0".join([*shared, *CFLAGS]))


def digest_of(text):
    return hashlib.sha256(text.encode()).hexdigest()[:16]


def compile_cpp(source, target, *options, waves=False):
    """Compiles a C++ file."""
    include, _ = verilator()
    run(["g++", *CFLAGS, *([f"-D{name}=1" for name in TRACES] if waves else []), "-I", include, "-I", HERE, *options, "-c", source, "-o", target], target.parent, f"g++ of {source.name}")
    return target


def shared_parts(waves):
    """Builds the parts that all twins share, once: the header of all models, Verilator's runtime, and the bench. Returns header and objects."""
    include, digest = verilator()
    parts = TARGET / "shared" / (f"{digest}-waves" if waves else digest)

    def header(folder):
        text = folder / "model.h"
        text.write_text('#include "verilated.h"\n#include "bench.h"\n')
        (parts / "model.h").write_text(text.read_text())
        return compile_cpp(text, folder / "model.h.gch", "-x", "c++-header", waves=waves)

    once(parts / "model.h.gch", header)
    sources = [include / "verilated.cpp", include / "verilated_threads.cpp", HERE / "bench.cpp"]
    sources += [include / "verilated_fst_c.cpp"] if waves else []
    return parts / "model.h", [once(parts / f"{path.stem}.o", lambda folder, path=path: compile_cpp(path, folder / "a.o", waves=waves)) for path in sources]


def build(unit, twin, source, inputs, outputs, parameters, files=(), waves=False):
    """Builds the bench of a twin unless a build of the same sources exists. Returns the program."""
    ports = [(f"IN{i}", fields, depth) for i, (fields, depth, _) in enumerate(inputs)]
    ports += [(f"OUT{o}", fields, depth) for o, (fields, depth, _) in enumerate(outputs)]
    texts = {
        "wires.sv": macros(ports),
        "top.sv": top(unit, twin, inputs, outputs, parameters, model_ports(outputs) if waves else []),
        "ports.h": accessors(inputs, outputs, sorted({*twin.ready, *twin.requests}), waves=waves),
        "unit.sv": source.read_text(),
        **{path.name: path.read_text() for path in library(inputs)},
        **dict(files),
    }
    return program_of(unit, texts, ["wires.sv", *(path.name for path in library(inputs)), "unit.sv", "top.sv"], waves)


def program_of(unit, texts, sources, waves=False):
    """Builds a bench unless a build of the same texts exists. Returns the program."""
    digest = digest_of("\0".join([verilator()[1], str(waves), *(f"{name}\0{text}" for name, text in sorted(texts.items()))]))
    folder = TARGET / "build" / f"{unit}-{digest}"

    def make(made):
        for name, text in texts.items():
            (folder / name).write_text(text)
        run(["verilator", "--cc", "-O3", "--unroll-count", "1024", "-Wno-fatal", "-Wno-lint", "-Wno-style", "--top-module", "top", "--Mdir", made,
             *(["--trace-fst"] if waves else []), *sources], folder, f"{unit}: Verilator")
        header, objects = shared_parts(waves)
        # One translation unit: most of the time to compile a part is that of its headers.
        model = made / "model.cpp"
        model.write_text("#define VL_INCLUDE_OPT include\n" + "".join(f'#include "{path.name}"\n' for path in sorted(made.glob("Vtop*.cpp")))
                         + texts["ports.h"])
        compile_cpp(model, made / "model.o", "-include", header, waves=waves)
        run(["g++", made / "model.o", *objects, "-pthread", "-latomic", *(["-lz"] if waves else []), "-o", made / "Vtop"], folder, f"{unit}: the linker")
        return made / "Vtop"

    return once(folder / "Vtop", make)
