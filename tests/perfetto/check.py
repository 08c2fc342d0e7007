"""Compares time lines with reports, by SQL in Perfetto's own trace processor.

    python check.py BASRELIEF

runs the simulator on a small scene of each machine and reads each trace as ui.perfetto.dev would. It compares the trace with the
report of the same run: slices with the cycles of units, counters with the counts of FIFOs and memories, and a window with the
whole trace. The program needs the packages of requirements.txt.
"""

import json
import pathlib
import subprocess
import sys
import tempfile

from trace_processor import Trace

RUNS = [
    "demo coin --size 64x48 --frames 2",
    "demo coin --size 64x48 --frames 1 --engine ticked",
    "demo goblet@1 --size 64x48 --set shade.mode=normal",
    "demo corridor --size 64x48",
    "demo corridor --machine defer --size 64x48",
]
# Window of `coin`: its units, first cycle and last cycle. It begins and ends within slices.
WINDOW = (["replacement", "brightness"], 20_011, 50_021)
NS_PER_S = 1_000_000_000
RATE_CYCLES = 256

# Values of each level with their durations. The last value lasts to the end of the run, which is the end of the last slice.
LEVELS = """
    SELECT t.name AS name, c.value AS value, c.ts AS ts,
           LEAD(c.ts, 1, (SELECT MAX(ts + dur) FROM slice)) OVER (PARTITION BY c.track_id ORDER BY c.ts) - c.ts AS dur
    FROM counter c JOIN track t ON c.track_id = t.id
"""


class Shown:
    """A trace with the report of its run."""

    def __init__(self, trace, report):
        self.trace = trace
        self.report = report
        self.ns = NS_PER_S // report["config"]["clock"]["hz"]
        self.checks = 0
        self.tracks = None

    def equal(self, what, shown, told):
        self.checks += 1
        if shown != told:
            raise AssertionError(f"{what}: the trace shows {shown}, the report says {told}")

    def unit(self, name):
        """Returns the track of a unit: its name, followed by the patent's numeral if it has one."""
        if self.tracks is None:
            self.tracks = {row.name for row in self.trace.query("SELECT name FROM track")}
        found = [track for track in self.tracks if track == name or track.startswith(f"{name} (")]
        return found[0] if found else None

    def slices(self, where):
        """Returns cycles and number of the slices of each track and name."""
        rows = self.trace.query(
            f"SELECT t.name AS track, s.name AS name, SUM(s.dur) AS dur, COUNT(*) AS n FROM slice s JOIN track t ON s.track_id = t.id "
            f"WHERE {where} GROUP BY 1, 2"
        )
        return {(row.track, row.name): (self.cycles(row.dur), row.n) for row in rows}

    def cycles(self, ns):
        if ns % self.ns:
            raise AssertionError(f"{ns} ns are no whole number of cycles of {self.ns} ns")
        return ns // self.ns

    def levels(self, suffix):
        """Returns, for each level with this suffix, its values and the cycles of each value."""
        rows = self.trace.query(f"SELECT name, value, SUM(dur) AS dur FROM ({LEVELS}) WHERE name LIKE '%{suffix}' GROUP BY 1, 2")
        levels = {}
        for row in rows:
            levels.setdefault(row.name.removesuffix(suffix), []).append((row.value, self.cycles(row.dur)))
        return levels


def check_health(shown):
    wrong = shown.trace.query("SELECT name, value FROM stats WHERE severity IN ('error', 'data_loss') AND value > 0")
    shown.equal("errors of the trace processor", [(row.name, row.value) for row in wrong], [])


def check_units(shown):
    slices = shown.slices("1")
    for name, unit in shown.report["units"].items():
        states = {"busy": unit["busy"], "done": unit["done"]}
        for cause in ("starved", "blocked", "memory"):
            states |= {f"{cause}: {of}": cycles for of, cycles in unit[cause].items()}
        for state, cycles in states.items():
            track = shown.unit(name)
            shown.equal(f"{name}, {state}", slices.get((track, state), (0, 0))[0], cycles)
    numerals = {name: str(unit["numeral"]) for name, unit in shown.report["units"].items() if unit.get("numeral")}
    for name, numeral in numerals.items():
        shown.equal(f"{name}, numeral", shown.unit(name), f"{name} ({numeral})")
    frames = [slices["frames", f"frame {k + 1}"][0] for k in range(len(shown.report["cycles"]["frames"]))]
    shown.equal("frames", frames, shown.report["cycles"]["frames"])


def check_fifos(shown):
    levels = shown.levels("")
    for name, fifo in shown.report["fifos"].items():
        histogram = [0] * (fifo["depth"] + 1)
        for value, cycles in levels[name]:
            histogram[int(value)] += cycles
        shown.equal(f"FIFO {name}", histogram, fifo["histogram"])


def check_memories(shown):
    buses = shown.slices("t.name LIKE 'memory %: bus'")
    banks = shown.slices("t.name LIKE 'memory %: bank %'")
    queues = shown.levels(": queue")
    check_rates(shown)
    for name, memory in shown.report["memories"].items():
        config = shown.report["config"]["memory"][name]
        of_clients = {client: 0 for client in memory["clients"]}
        for number, channel in enumerate(memory["channels"]):
            track = f"memory {name} {number}" if len(memory["channels"]) > 1 else f"memory {name}"
            own = {slice_name: cycles for (of, slice_name), (cycles, _) in buses.items() if of == f"{track}: bus"}
            shown.equal(f"{track}, cycles of the bus", sum(own.values()), channel["bus_busy"])
            for slice_name, cycles in own.items():
                of_clients[slice_name.rsplit(" ", 1)[0]] += cycles
            rows = sum(n for (of, _), (_, n) in banks.items() if of.startswith(f"{track}: bank "))
            shown.equal(f"{track}, rows opened", rows, channel["row_closed"] + channel["row_conflicts"])
            queued = sum(value * cycles for value, cycles in queues[track])
            shown.equal(f"{track}, bursts that wait", queued, channel["queued"])
        for client, cycles in of_clients.items():
            moved = cycles * config["burst_bytes"] // config["burst_cycles"]
            shown.equal(f"{name}, bytes of {client}", moved, memory["clients"][client]["bursts"] * config["burst_bytes"])
    credits = shown.levels(": credits")
    for name, memory in shown.report["memories"].items():
        # The display holds no credits, and flips and waits have credits of their own.
        ports = [client for client in memory["clients"] if client not in ("scan_out", "flip", "hold")]
        most = {client: max(value for value, _ in credits[f"client {client}"]) for client in ports}
        shown.equal(f"{name}, credits", set(most.values()), {shown.report["config"]["memory"][name]["outstanding"]})


def check_rates(shown):
    """Checks that the sum of bytes per cycle over all cycles is the number of moved bytes."""
    rows = shown.levels(": bytes per cycle")
    for name, memory in shown.report["memories"].items():
        config, channels = shown.report["config"]["memory"][name], memory["channels"]
        for number, channel in enumerate(channels):
            track = f"memory {name} {number}" if len(channels) > 1 else f"memory {name}"
            # The rate of the last interval refers to a full interval, but the run may end within it.
            last = shown.report["cycles"]["total"] % RATE_CYCLES
            bytes_moved = channel["bus_busy"] * config["burst_bytes"] / config["burst_cycles"]
            held = sum(value * cycles for value, cycles in rows[track])
            most = max(value for value, _ in rows[track])
            missing = bytes_moved - held
            shown.equal(f"{track}, bytes per cycle", 0 <= missing <= most * (RATE_CYCLES - last), True)


def check_caches(shown):
    rates = shown.levels(": hit rate")
    for name, cache in shown.report["caches"].items():
        values = [value for value, _ in rates[f"cache {name}"]]
        shown.equal(f"cache {name}, percent", all(0 <= value <= 100 for value in values), True)
        shown.equal(f"cache {name}, whether it ever hits", max(values) > 0, cache["hits"] > 0)


def check_whose(shown):
    """Checks that the slices of each object and polygon have the cycles that the report attributes to it."""
    arguments = ", ".join(f"EXTRACT_ARG(s.arg_set_id, 'debug.{name}') AS {name}" for name in ("frame", "object", "polygon"))
    rows = shown.trace.query(
        f"SELECT {arguments}, SUM(s.dur) AS dur FROM slice s JOIN track t ON s.track_id = t.id "
        "WHERE t.name NOT LIKE 'memory %' AND t.name <> 'frames' GROUP BY 1, 2, 3"
    )
    objects, polygons, framed = {}, {}, 0
    for row in rows:
        cycles = shown.cycles(row.dur)
        framed += cycles if row.frame is not None else 0
        objects[row.object] = objects.get(row.object, 0) + cycles
        polygons[row.frame, row.polygon] = polygons.get((row.frame, row.polygon), 0) + cycles
    costs = shown.report["costs"]
    shown.equal("all frames", framed, sum(frame["cycles"] for frame in costs["frames"]))
    for told in costs["objects"]:
        shown.equal(f"object {told['object']}", objects[told["object"]], told["breakdown"]["cycles"])
    for told in costs["polygons"]:
        at = f"frame {told['frame']}, polygon {told['polygon']}"
        shown.equal(at, polygons[told["frame"] + 1, told["polygon"]], told["breakdown"]["cycles"])
    shown.equal("whether there are polygons", len(costs["polygons"]) > 5, True)


def check_colors(shown):
    """Checks that the slices of a cause have one colour, and that those of different causes differ."""
    rows = shown.trace.query(
        "SELECT DISTINCT s.name AS name, EXTRACT_ARG(s.arg_set_id, 'correlation_id') AS color FROM slice s JOIN track t ON s.track_id = t.id "
        "WHERE t.name NOT LIKE 'memory %' AND t.name <> 'frames'"
    )
    colors = {}
    for row in rows:
        colors.setdefault(row.name.split(":")[0], set()).add(row.color)
    shown.equal("colours of each cause", {cause: len(of) for cause, of in colors.items()}, dict.fromkeys(colors, 1))
    shown.equal("colours of all causes", len(set.union(*colors.values())), len(colors))


def check_flows(shown):
    """Checks that flows lead forwards in time from a busy slice to a busy slice, also of another unit."""
    rows = shown.trace.query(
        "SELECT a.name AS tail, b.name AS head, a.track_id = b.track_id AS one_unit, a.ts <= b.ts AS forwards, COUNT(*) AS n "
        "FROM flow f JOIN slice a ON f.slice_out = a.id JOIN slice b ON f.slice_in = b.id GROUP BY 1, 2, 3, 4"
    )
    shown.equal("slices with flows", {(row.tail, row.head, row.forwards) for row in rows}, {("busy", "busy", 1)})
    shown.equal("whether flows join units", sum(row.n for row in rows if not row.one_unit) > 10, True)


def check_window(run, simulator, folder, whole):
    """Checks that a window equals that part of the whole trace: slices cut at its ends, and levels from its beginning."""
    units, start, end = WINDOW
    window = traced(f"{run} --units {','.join(units)} --from-cycle {start} --to-cycle {end}", simulator, folder)
    shown_units = [whole.unit(unit) for unit in units]
    first, last = start * whole.ns, end * whole.ns
    slices = (
        "SELECT t.name AS track, s.name AS name, MAX(s.ts, {first}) AS ts, MIN(s.ts + s.dur, {last}) AS until FROM slice s "
        "JOIN track t ON s.track_id = t.id WHERE s.ts < {last} AND s.ts + s.dur > {first} AND t.name IN ({names}) ORDER BY 1, 3"
    ).format(first=first, last=last, names=", ".join(f"'{name}'" for name in [*shown_units, "frames"]))
    rows = [[(row.track, row.name, row.ts, row.until) for row in shown.trace.query(slices)] for shown in (window, whole)]
    window.equal("slices of the window", *rows)
    window.equal("whether there are any", len(rows[0]) > 100, True)
    beyond = window.trace.query(f"SELECT COUNT(*) AS n FROM slice WHERE ts < {first} OR ts + dur > {last}")
    window.equal("slices beyond the window", beyond[0].n, 0)
    beginning = f"SELECT name, value FROM ({LEVELS}) WHERE ts <= {first} AND (ts + dur > {first}) ORDER BY 1"
    at_start = [{row.name: row.value for row in shown.trace.query(beginning)} for shown in (window, whole)]
    told = {name: value for name, value in at_start[1].items() if name in at_start[0]}
    window.equal("levels at the window's beginning", at_start[0], told)
    window.equal("whether there are any", len(told) > 5, True)
    tracks = {row.name for row in window.trace.query("SELECT DISTINCT t.name AS name FROM slice s JOIN track t ON s.track_id = t.id")}
    others = {whole.unit(name) for name in whole.report["units"] if name not in units}
    window.equal("other units", tracks & others, set())
    return window.checks


def traced(run, simulator, folder):
    trace, out = folder / "t.pftrace", folder / "out"
    subprocess.run([simulator, *run.split(), "--timeline", trace, "--out", out, "--costs", "--no-exact", "--no-bottlenecks", "--quiet"], check=True)
    return Shown(Trace(trace), json.loads((out / "report.json").read_text()))


def main():
    simulator = pathlib.Path(sys.argv[1]).resolve()
    for run in RUNS:
        with tempfile.TemporaryDirectory() as folder:
            folder = pathlib.Path(folder)
            shown = traced(run, simulator, folder)
            for check in (check_health, check_units, check_fifos, check_memories, check_caches, check_whose, check_colors, check_flows):
                check(shown)
            checks = shown.checks + (check_window(run, simulator, folder, shown) if run == RUNS[0] else 0)
            print(f"{run}: {checks} comparisons", flush=True)


if __name__ == "__main__":
    main()
