"""Chain of twins in one model: joined by FIFOs, so that a difference anywhere moves everything after it.

The bench supplies the tokens of the first FIFO, the values of timing twins, and the recorded times of memory answers and credits. It compares each step and
each token.
"""

import re

from build import LIBRARY, OF_PIXELS, accessors, macros, model_ports, padded, program_of
from recording import width
from twins import TWINS

# The units of a chain, in the order of the tokens, by machine.
CHAINS = {"bump": ["geometry", "rasterizer", "depth_test", "distributor", "normal_mapping", "replacement", "brightness", "graphics", "frame_buffer"]}


class Link:
    """Twin in a chain: its stage, the fields at its ends, and its tokens."""

    def __init__(self, number, unit, recording, tokens_of, wires_of):
        self.number, self.unit, self.twin = number, unit, TWINS[unit]
        self.stage = next(recording.stage(stage) for machine, stage in self.twin.stages if machine == recording.machine)
        self.names = recording.stages[self.stage]
        ends = [[wires_of(recording, name) for name in self.names[key]] for key in ("inputs", "outputs")]
        self.tokens = tokens_of(recording, self.stage)
        self.inputs, self.outputs = self.twin.rewrite(recording, self.stage, *ends, self.tokens) if self.twin.rewrite else ends
        self.parameters = self.twin.parameters(recording, self.stage)
        self.files = self.twin.files(recording, self.stage) if self.twin.files else {}
        self.clients = sorted({*self.twin.ready, *self.twin.requests})


class Chain:
    """Links of a recording, the FIFOs between them, and the ports of the bench."""

    def __init__(self, recording, tokens_of, wires_of):
        self.recording = recording
        self.links = [Link(n, unit, recording, tokens_of, wires_of) for n, unit in enumerate(CHAINS[recording.machine])]
        ends = lambda key: {name: (link, i) for link in self.links for i, name in enumerate(link.names[key])}  # noqa: E731
        self.producers, self.consumers = ends("outputs"), ends("inputs")
        self.inner = [name for name in self.producers if name in self.consumers]
        self.outer = [name for name in self.consumers if name not in self.producers]
        self.ports = {}
        for link in self.links:
            for k in link.clients:
                self.ports[link.number, k] = len(self.ports)

    def fields(self, name):
        """Returns fields, depth and latency of a FIFO. Its consumer may need more bits than its producer delivers."""
        link, i = self.consumers[name]
        return link.inputs[i]

    def nexts(self):
        """Returns the FIFOs whose consumers need bits that the bench adds to delivered tokens."""
        return [o for o, name in enumerate(self.inner) if width(self.fields(name)[0]) > width(self.producer_fields(name))]

    def producer_fields(self, name):
        link, i = self.producers[name]
        return link.outputs[i][0]

    def expected(self, name):
        """Returns the tokens of a FIFO between two twins, with the bits that the bench adds."""
        (link, o), (consumer, i) = self.producers[name], self.consumers[name]
        w = width(self.producer_fields(name))
        return [bits | taken >> w << w for bits, taken in zip(link.tokens["out"][o], consumer.tokens["in"][i], strict=True)]

    def top(self, waves):
        """Returns the module around the twins."""
        ports, body = ["input wire clk, rst"], []
        if waves:
            ports += model_ports([self.fields(name) for name in self.inner], len(self.links))
        for number, name in enumerate(self.outer):
            fields, depth, latency = self.fields(name)
            w, p = width(fields), padded(width(fields))
            ports += [f"input wire i{number}_reserve, i{number}_push", f"input wire [{p - 1}:0] i{number}_data", f"output wire i{number}_room"]
            body.append(f"wire {name}_valid, {name}_pop; wire [{w - 1}:0] {name}_front;")
            body.append(f"fifo #(.W({w}), .DEPTH({depth}), .LATENCY({latency})) {name} (.clk, .rst, .room(i{number}_room), .reserve(i{number}_reserve), "
                        f".push(i{number}_push), .push_data(i{number}_data[{w - 1}:0]), .valid({name}_valid), .data({name}_front), .pop({name}_pop));")
        for o, name in enumerate(self.inner):
            fields, depth, latency = self.fields(name)
            w, p, produced = width(fields), padded(width(fields)), width(self.producer_fields(name))
            ports += [f"input wire o{o}_pop", f"input wire [{p - 1}:0] o{o}_pass, o{o}_next", f"output wire o{o}_valid, o{o}_push, o{o}_reserve"]
            ports.append(f"output wire [{p - 1}:0] o{o}_data")
            body.append(f"wire {name}_room, {name}_valid, {name}_pop; wire [{w - 1}:0] {name}_front; wire [{produced - 1}:0] {name}_made;")
            given = f"{{o{o}_next[{w - 1}:{produced}], {name}_made}}" if w > produced else f"{name}_made"
            body.append(f"fifo #(.W({w}), .DEPTH({depth}), .LATENCY({latency})) {name} (.clk, .rst, .room({name}_room), .reserve(o{o}_reserve), "
                        f".push(o{o}_push), .push_data({given}), .valid({name}_valid), .data({name}_front), .pop({name}_pop));")
            body.append(f"assign o{o}_valid = {name}_valid; assign o{o}_data = {given};")
        for link in self.links:
            self.instance(link, ports, body)
        return f"module top ({', '.join(ports)});\n    " + "\n    ".join(body) + "\nendmodule\n"

    def instance(self, link, ports, body):
        """Adds a twin with its ports of memory."""
        n = link.number
        ports += [f"input wire [31:0] answered_{n}", f"output wire start_{n}"]
        pins = [".clk(clk)", ".rst(rst)", f".start(start_{n})"]
        for i, name in enumerate(link.names["inputs"]):
            pins += [f".in{i}_valid({name}_valid)", f".in{i}({name}_front)", f".in{i}_pop({name}_pop)"]
        for o, name in enumerate(link.names["outputs"]):
            port, w = self.inner.index(name), width(self.producer_fields(name))
            pins += [f".out{o}_room({name}_room)", f".out{o}_reserve(o{port}_reserve)", f".out{o}_push(o{port}_push)", f".out{o}({name}_made)"]
            if o in link.twin.passes:
                pins.append(f".pass{o}(o{port}_pass[{w - 1}:0])")
        for k in link.clients:
            m = self.ports[n, k]
            ports += [f"input wire m{m}_ready", f"output wire m{m}_request", f"output wire [47:0] m{m}_address"]
            if k in link.twin.ready:
                pins.append(f".mem{k}_ready(m{m}_ready)")
            if k in link.twin.requests:
                pins += [f".mem{k}_request(m{m}_request)", f".mem{k}_address(m{m}_address)"]
            else:
                body.append(f"assign m{m}_request = 1'b0; assign m{m}_address = 48'd0;")
        if link.twin.is_answered:
            pins.append(f".answered(answered_{n})")
        values = ", ".join(f".{name}({value})" for name, value in link.parameters.items())
        body.append(f"{link.unit} #({values}) {link.unit} ({', '.join(pins)});" if values else f"{link.unit} {link.unit} ({', '.join(pins)});")

    def build(self, sources, waves=False):
        """Builds the bench. `sources` gives a file for each unit. Returns the program."""
        texts = {path.name: path.read_text() for path in LIBRARY if path.name not in OF_PIXELS}
        order = list(texts)
        for link in self.links:
            ports = [(f"IN{i}", fields, depth) for i, (fields, depth, _) in enumerate(link.inputs)]
            ports += [(f"OUT{o}", fields, depth) for o, (fields, depth, _) in enumerate(link.outputs)]
            # Macros and modules that follow from the fields of a token differ between units.
            text = "`undefineall\n" + macros(ports)
            unit = sources[link.unit].read_text()
            for path in LIBRARY:
                if path.name in OF_PIXELS and re.search(rf"\b{path.stem}\b", unit):
                    text += re.sub(rf"\b{path.stem}\b", f"{path.stem}_{link.number}", path.read_text())
                    unit = re.sub(rf"\b{path.stem}\b", f"{path.stem}_{link.number}", unit)
            texts[f"{link.unit}.sv"] = text + unit
            order.append(f"{link.unit}.sv")
            texts.update(link.files)
        texts["top.sv"] = self.top(waves)
        inputs, outputs = [self.fields(name) for name in self.outer], [self.fields(name) for name in self.inner]
        texts["ports.h"] = accessors(inputs, outputs, range(len(self.ports)), len(self.links), self.nexts(), waves)
        return program_of("chain", texts, [*order, "top.sv"], waves)

    def events(self, steps_of):
        """Returns the input of the bench."""
        recording, lines = self.recording, []
        for number, name in enumerate(self.outer):
            link, i = self.consumers[name]
            delivered = zip(recording.end_of(name, True), link.tokens["in"][i], recording.visible.get(recording.fifo(name), []))
            lines += [f"in {number} {start} {cycle - recording.latency[name]} {bits:x}" for (start, _), bits, cycle in delivered]
        for o, name in enumerate(self.inner):
            visible = recording.visible.get(recording.fifo(name), [])
            lines += [f"out {o} {cycle - recording.latency[name]} -1 {bits:x}" for bits, cycle in zip(self.expected(name), visible)]
        for link in self.links:
            lines += steps_of(recording, link.stage, link.twin, link.number, lambda k, n=link.number: self.ports[n, k])
        return [*lines, f"end {recording.end + 4}"]
