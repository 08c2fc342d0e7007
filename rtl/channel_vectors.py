"""Vectors of a channel of law 4: random bursts, and the column commands that the executable laws of `tests/oracles/laws.py` give for them.

The first seed has the timing of the machine's graphics memory, others have random timing.
"""

import pathlib
import random
import sys

from recording import Recording

sys.path.append(str(pathlib.Path(__file__).resolve().parent.parent / "tests" / "oracles"))
import laws  # noqa: E402

BURSTS, QUEUE, SEEDS = 2000, 64, 6
FIELDS = {
    "bursts": [("write", 0, 1), ("bank", 1, 6), ("row", 7, 20), ("number", 27, 16), ("rest", 43, 32)],
    "commands": [("number", 0, 16), ("outcome", 16, 2), ("rest", 18, 50)],
}
OUTCOMES = ["row_hits", "row_closed", "row_conflicts"]
TIMES = ["cl", "cwl", "rcd", "rp", "ras", "rtp", "wr", "wtr", "rrd", "faw"]


class ChannelVectors(Recording):
    """Vectors of a channel, in the form of a recording of a machine with the stages `requests`, `channel` and `data`."""

    def __init__(self, machine, timing, seed):
        self.path, self.machine, self.config = f"synthetic-{seed}", machine, {"channel": timing}
        self.stages = [dict(name=name, inputs=inputs, outputs=outputs, clients=[])
                       for name, inputs, outputs in (("requests", [], ["bursts"]), ("channel", ["bursts"], ["commands"]), ("data", ["commands"], []))]
        self.fifos = [dict(name="bursts", depth=4), dict(name="commands", depth=2)]
        self.clients, self.credits, self.in_flight, self.tables, self.answers = [], {}, {}, {}, {}
        self.fields, self.latency = FIELDS, {"bursts": 1, "commands": 1}
        rng, channel = random.Random(f"channel {seed}"), laws.Channel(timing)
        arrivals, commands, cycle, rows = [], [], 2, [0] * timing["banks"]
        while len(commands) < BURSTS:
            served = self.decide(channel, timing, cycle)
            commands += [(cycle, *served)] if served else []
            # As many as the queue holds, in crowds with pauses.
            if len(arrivals) < BURSTS and len(channel.queue) < QUEUE - 1 and rng.random() < (0.9 if cycle // 400 % 2 else 0.1):
                bank = rng.randrange(timing["banks"])
                if rng.random() < 0.4:
                    rows[bank] = rng.randrange(6)
                burst = dict(bank=bank, row=rows[bank], write=rng.random() < 0.3, number=len(arrivals))
                channel.queue.append(burst)
                arrivals.append((cycle, burst))
            cycle += 1
        bits = lambda b: int(b["write"]) | b["bank"] << 1 | b["row"] << 7 | b["number"] << 27  # noqa: E731
        given = [number | OUTCOMES.index(outcome) << 16 for _, number, outcome in commands]
        step = lambda start, taken=0, **given: dict(start=start, end=start + 1, taken=taken, given=given.get("given", {}), requests=[])  # noqa: E731
        # A burst arrives in the cycle in which the channel accepts it, one cycle after its delivery to the FIFO.
        self.steps = {
            0: [step(at - 1, given={0: bits(burst)}) for at, burst in arrivals],
            1: sorted([step(at, 1) for at, _ in arrivals], key=lambda s: s["start"]),
            2: [step(at + 1, 1) for at, *_ in commands],
        }
        self.given = given
        self.visible = {0: [at for at, _ in arrivals], 1: [at + 1 for at, *_ in commands]}
        self.end = cycle + 2

    @staticmethod
    def decide(channel, timing, cycle):
        """Serves the burst of this cycle. Returns its number and its row outcome, if there is one."""
        window = channel.queue[: timing["window"]]
        for burst in window:
            burst.setdefault("view", cycle)
        for burst in window[:1] if channel.passed >= timing["cap"] else window:
            found = (burst, *channel.column(burst))
            if found[1] == cycle:
                channel.passed = 0 if burst is channel.queue[0] else channel.passed + 1
                channel.serve(*found)
                return burst["number"], found[2]
        return None


def channel_vectors(base, seed):
    """Returns vectors with the timing of the graphics memory, or with random timing."""
    timing = dict(base.config["memory"]["graphics"])
    if seed:
        rng = random.Random(f"timing {seed}")
        timing.update({name: rng.randint(1 if name in ("rcd", "rp") else 0, 9) for name in TIMES})
        timing.update(banks=rng.choice([2, 4, 8]), window=rng.choice([1, 2, 4, 8]), cap=rng.choice([0, 2, 16]), burst_cycles=rng.randint(1, 4),
                      faw=rng.choice([0, 30]), refi=rng.choice([0, 200]), rfc=20, commands_per_cycle=seed % 2)
    return ChannelVectors(base.machine, timing, seed)


def channel(recording, _):
    """Returns the parameters of a channel."""
    timing = recording.config["channel"]
    names = {name.upper(): timing[name] for name in [*TIMES, "window", "cap", "banks", "refi", "rfc"]}
    return dict(names, BURST=timing["burst_cycles"], BUS=timing["commands_per_cycle"], QUEUE=QUEUE)


def channel_tokens(recording, _, inputs, outputs, tokens):
    """Adds the commands. The steps of a channel are arrivals, and its commands have cycles of their own."""
    tokens["out"][0] = recording.given
    return inputs, outputs
