#!/usr/bin/env python3
"""laws.py - the laws of time (third edition), executable: a slow per-cycle simulator of small plans.

  laws.py run PLAN.json          print the result of a plan as canonical JSON
  laws.py make SEED [N] DIR      write N random plans with their results: DIR/<seed>.json = {"plan": ..., "result": ...}

The crate documentation of the kernel states the laws in words. This program is an independent oracle for them: it simulates
cycle by cycle and shares no code with the engines. An engine is right if it prints the same result for every plan.

PLAN  {"fifos":    [{"name", "depth", "latency", optional "period"}],
       "memories": [{"name", "burst_bytes", "burst_cycles", "channels", "channel_bytes", "banks", "row_bytes", "window", "cap",
                     "cl", "cwl", "rcd", "rp", "ras", "rtp", "wr", "wtr", "rrd", "faw", "refi", "rfc", optional "commands_per_cycle",
                     "ports": [{"name", "outstanding", optional "flips": {"of", "period", "hold", optional "wait"}}], optional "periodic": [{"name", "period", "bytes", "stride", "span"}]}],
       "caches":   [{"name", "port", "line_bytes", "sets", "ways", "hit_latency", "lookups_per_cycle", optional "at_once", optional "always_hits"}],
       "units":    [{"name", "kind", "in": [fifo], "out": [fifo], "occupancy": [..], "latency": [..], ...,
                     optional "after": [..], optional "blocking", optional "issue", optional "ideal"}]}
A token is (id, last). Occupancy and latency are lists indexed by id modulo length, where id is: source - of the token it emits; expand -
of the child that the step emits; join - of its first input's token; merge - the new number k; otherwise of the popped token. A port belongs to
exactly one unit or cache, a cache to exactly one unit; a step's largest need of a port is the number of entries of "requests" on it, or of
"lookups", and may not exceed "outstanding".
kind     takes                     emits
source   -                         "tokens" tokens 0, 1, ..; the final one has last
work     its input                 the same token
fork     its input                 the same token to every output
join     all inputs                the token of the first input (last if any has last)
route    its input                 the token to output id mod (number of outputs) only; a last token to that output only
merge    input k mod n (k = steps) that token; ids renumbered k; last when all "tokens" have passed
expand   its input, then none      "factor" children id * factor + j, one per step; last on the final child of a last token
gather   its input                 id // "size" when (id + 1) mod size = 0 and on last; otherwise nothing (no slot is reserved)
access   its input                 the same token; each step issues "requests" [{"port", "write", "bytes", "stride", "offset", "span"}]
                                   at address (id * stride + offset) mod span
cached   its input                 the same token; each step looks up "lookups" [{"stride", "offset", "span"}] in cache "cache"
mixed    its input                 the same token; a step of id looks up "lookups" in "cache" if id mod "look_up_every" = 0, and issues request
                                   i of "requests" if id mod every[i mod length] = 0. It blocks if blocks[id mod length]
gate     input 0 "size" times,     the token of input 0; nothing for a token of input 1
         then input 1, and again
tap      its input                 the same token to output 0; every "size"-th also to output 1. Gate and tap close a loop, with as many
                                   tokens between them as the gate passes
sink     its input                 -
Memories: a burst at byte address a is in channel (a div channel_bytes) mod channels, and there at address x = (a div (channel_bytes *
channels)) * channel_bytes + a mod channel_bytes; row number = x div row_bytes, bank = row number mod banks, row = row number div banks.
At first all banks are closed and no command was ever given. Per channel and cycle: the bursts that arrived before this cycle stand in
order of (arrival, port number, issue, address), and the first `window` of those not served are in view, each from the cycle in which it comes
into view on. Of those whose column command can go in this cycle the oldest goes; only the oldest in view may go once it has been passed over
`cap` times. When its column command can go is `column` below: row commands are given as early as the bank allows, also while others move
data. refi = 0: no refresh; else rfc + rcd < refi. An answer is there when the last data of all the request's bursts have moved, not before the port's answer ahead of
it; the credit is back in that same cycle.
Command bus: a channel carries at most "commands_per_cycle" precharges, activations and column commands per cycle (default 0: any number); with
a limit rcd and rp count as at least 1. A precharge is rp before its activation. A row command takes the first cycle with room, counting the commands
of all bursts served before, and comes after the column command of the burst served `window` bursts before.
Work after data: a step delivers at max(start + latency, each of its answers + after). "after" is a list like "latency" (default 0).
Blocking: a step of a unit with "blocking" keeps the unit until the last of its answers. The cycles between its occupancy and that answer
count as memory of its first port, in order of first mention, whose answers are not all there.
Issue rate: an access unit issues "issue" requests per cycle on each port (default 0: all at once). Request n of the step on a port arrives in
cycle start + n div issue, and the occupancy is at least ceil(requests on the port / issue). Credits for all are taken at the start.
Periodic FIFO: a token of a FIFO with a "period" is visible from the smallest multiple of the period that is not before max(d + f, visible
time of the token before + 1), where d is its delivery and f the latency of the FIFO.
Periodic client: it reads request k = 0, 1, .. in cycle k * period at address (k * stride) mod span, without credits, as long as the run
lasts. Periodic clients have the port numbers after the other ports of the memory. They keep no run alive and do not count towards total.
Their requests count if they arrive before total, their bursts if the column command is before total.
Flips: a request on a port with "flips" moves no data. If it arrives in cycle c at address A, it takes effect in cycle e, the smallest multiple
of the flips' "period" that is not before max(c, e of the flip before + max("hold", 1)). The periodic client "of" then has A as its base: its
requests from e on are at A + (k * stride) mod span. At first the base is 0. With "hold" > 0, it makes no requests before the first flip, nor from
e + hold until the next flip. The answer comes at max(e + hold, c + 1 + min(cl, cwl) + burst_cycles), and not before the port's answer ahead.
Waits: a request on a port whose flips have "wait" is no flip. If it arrives in cycle c, it is answered at max(e + hold of the last flip of "of"
before it in order of (arrival, port number, issue), c + 1 + min(cl, cwl) + burst_cycles), and not before the port's answer ahead.
Ideal: a step of a unit with "ideal" has occupancy 1 and latency max(0, latency - occupancy + 1), before the minima of its requests and look-ups.
Caches: the look-ups of a cached step are its distinct lines in order of first mention, and its occupancy is max(occupancy, ceil(distinct
lines / lookups_per_cycle)). Look-up n is made in cycle start + n div lookups_per_cycle, or at the start if the cache is "at_once". A miss
arrives at its memory in the cycle of the look-up. A look-up at s of a line in the tags whose memory answer is > s is merged, otherwise a
hit; a line replaced before its fill is absent: a new miss. Hits, merged look-ups and misses all touch LRU. A cached step awaits its port
until its last look-up's answer, hit latency included. In a cache with "always_hits" every look-up is a hit, and none touches LRU. If a full output's oldest holder awaits several ports, the lowest memory number and
then the lowest port number counts first. Complete = no token in a FIFO, every source and merge has passed all its tokens, no expand part-way;
otherwise deadlock. "done" counts from the end of a unit's last step, or from its last answer if it blocks, in a complete run; in a
deadlock only sources and merges that have passed all tokens are done, the others keep the cause that holds them.
RESULT {"outcome": "complete" | "deadlock", "total", "units": {name: {"steps", "busy", "done", "starved": {fifo: n},
        "memory": {port: n}, "blocked": {fifo: n}}}, "fifos": {name: histogram}, "memories": {name: {port: {"requests",
        "bursts", "row_hits", "row_closed", "row_conflicts"}}}, "caches": {name: {"hits", "misses", "merged"}}}; starved, memory and blocked
        hold non-zero entries only.
"""
import json, random, sys

class Fifo:
    def __init__(s, d): s.depth, s.latency, s.period, s.entries, s.head, s.settled, s.last_visible = d["depth"], d["latency"], d.get("period", 1), [], 0, 0, -1
    def held(s, c): return sum(1 for e in s.entries[s.head:]) + (1 if s.head and s.entries[s.head - 1]["popped"] == c else 0)
    def room(s, c): return s.held(c) < s.depth
    def front(s, c): return s.entries[s.head] if s.head < len(s.entries) and s.entries[s.head].get("visible", 1 << 60) <= c else None

class Channel:
    def __init__(s, d):
        s.d, s.queue, s.passed, s.last, s.acts = d, [], 0, None, [-1 << 40] * 4     # last: (column command, is a write)
        s.bus = d.get("commands_per_cycle", 0); s.commands, s.columns = {}, []      # commands by cycle; column commands in order
        s.rcd, s.rp = (max(d["rcd"], 1), max(d["rp"], 1)) if s.bus else (d["rcd"], d["rp"])
        s.banks = [{"row": None, "act": -1 << 40, "free": 0, "refreshes": 0} for _ in range(d["banks"])]   # free: may be precharged or, closed, activated
    def column(s, q):
        """First cycle in which the column command of burst q can go, were it the next; with the kind of access and the activation."""
        d, k, c = s.d, dict(s.banks[q["bank"]]), 0
        if s.last:
            at, wrote = s.last
            c = at + (d["burst_cycles"] if wrote == q["write"] else d["cwl"] + d["burst_cycles"] + d["wtr"] if wrote else max(d["burst_cycles"], d["cl"] + d["burst_cycles"] + 1 - d["cwl"]))
        while True:
            kind = "row_hits" if k["row"] == q["row"] else "row_closed" if k["row"] is None else "row_conflicts"
            act = k["act"]
            if kind != "row_hits": act = max(max(q["view"], k["free"]) + (s.rp if kind == "row_conflicts" else 0), s.acts[-1] + d["rrd"], s.acts[-4] + d["faw"])
            if s.bus and kind != "row_hits":
                before = [0] + ([s.rp] if kind == "row_conflicts" else [])          # its row commands: so many cycles before the activation
                if len(s.columns) >= d["window"]: act = max(act, s.columns[-d["window"]] + 1 + before[-1])
                while any(s.commands.get(act - b, 0) >= s.bus for b in before): act += 1
            at = max(c, q["view"], act + s.rcd)
            if not d["refi"] or at // d["refi"] <= k["refreshes"]: return at, kind, act, k["refreshes"]
            n = at // d["refi"]; k.update(row=None, refreshes=n, free=n * d["refi"] + d["rfc"])         # refresh n closes every bank
    def serve(s, q, at, kind, act, refreshes):
        d, k = s.d, s.banks[q["bank"]]; s.queue.remove(q); s.columns.append(at)
        for x in [at] + ([act] if kind != "row_hits" else []) + ([act - s.rp] if kind == "row_conflicts" else []): s.commands[x] = s.commands.get(x, 0) + 1
        if kind != "row_hits": s.acts = s.acts[1:] + [act]; k.update(row=q["row"], act=act, free=act + d["ras"])
        k["refreshes"] = refreshes; s.last = (at, q["write"])
        k["free"] = max(k["free"], at + d["cwl"] + d["burst_cycles"] + d["wr"] if q["write"] else at + d["rtp"])
        return at + (d["cwl"] if q["write"] else d["cl"]) + d["burst_cycles"]

class Memory:
    def __init__(s, d):
        s.d, s.last_data, s.channels = d, -1, [Channel(d) for _ in range(d["channels"])]
        s.ports = [{"name": p["name"], "credits": p["outstanding"], "returns": [], "answer": 0, "open": [], "requests": 0, "bursts": 0, "row_hits": 0, "row_closed": 0, "row_conflicts": 0} for p in d["ports"]]
        s.users = len(s.ports); s.ports += [dict(p, returns=[], answer=0, open=[], credits=0, requests=0, bursts=0, arrivals=[], columns=[], row_hits=0, row_closed=0, row_conflicts=0) for p in d.get("periodic", [])]
        s.flips = {v: {"base": 0, "changes": [], "next": 0, "held": 0} for v in range(s.users, len(s.ports))}      # by number of the periodic client
        for p, q in zip(s.ports, d["ports"]):
            f = p["flips"] = q.get("flips")
            if f:
                v = p["shows"] = s.flips[next(i for i in s.flips if s.ports[i]["name"] == f["of"])]
                if f["hold"] and not f.get("wait"): v["base"] = None
        s.arrived = []                                   # (port number, issue order, address, bytes, write, callback) of this cycle
    def serve(s, c):
        """Column commands of cycle c, then the requests that arrive in it."""
        d = s.d
        for ch in s.channels:
            for q in ch.queue[:d["window"]]: q.setdefault("view", c)
            able = [(q,) + ch.column(q) for q in (ch.queue[:1] if ch.passed >= d["cap"] else ch.queue[:d["window"]])]
            go = next((x for x in able if x[1] == c), None)
            if go:
                q, p = go[0], s.ports[go[0]["port"]]; ch.passed = 0 if q is ch.queue[0] else ch.passed + 1
                end = ch.serve(*go); p[go[2]] += 1; p["bursts"] += 1
                if q["port"] < s.users: s.last_data = max(s.last_data, end - 1)
                else: p["columns"].append((c, go[2]))
                r = q["request"]; r["left"] -= 1; r["end"] = max(r["end"], end)
                while p["open"] and not p["open"][0]["left"]:
                    r = p["open"].pop(0); p["answer"] = max(p["answer"], r["end"]); p["returns"].append(p["answer"]); r["done"](p["answer"])
        for n, _, address, size, write, done in sorted(s.arrived, key=lambda r: r[:2]):
            p = s.ports[n]
            if n >= s.users:                             # all flips of this cycle have come
                v = s.flips[n]
                while v["changes"] and v["changes"][0][0] <= c: v["base"] = v["changes"].pop(0)[1]
                if v["base"] is None: continue
                p["arrivals"].append(c); address += v["base"]
            p["requests"] += 1
            if p.get("flips"):
                v, f = p["shows"], p["flips"]
                if not f.get("wait"):
                    e = -(-max(c, v["next"]) // f["period"]) * f["period"]; v["held"] = e + f["hold"]
                    v["next"] = e + max(f["hold"], 1); v["changes"] += [(e, address)] + ([(e + f["hold"], None)] if f["hold"] else [])
                p["answer"] = max(p["answer"], v["held"], c + 1 + min(d["cl"], d["cwl"]) + d["burst_cycles"]); p["returns"].append(p["answer"]); done(p["answer"])
                continue
            bursts = range(address // d["burst_bytes"], (address + size - 1) // d["burst_bytes"] + 1)
            r = {"left": len(bursts), "end": 0, "done": done}; p["open"].append(r)
            for b in bursts:
                a = b * d["burst_bytes"]; m = a // d["channel_bytes"]
                row = (m // d["channels"] * d["channel_bytes"] + a % d["channel_bytes"]) // d["row_bytes"]
                s.channels[m % d["channels"]].queue.append({"bank": row % d["banks"], "row": row // d["banks"], "write": write, "port": n, "request": r})
        s.arrived = []
    def tick(s, c):
        """Requests of periodic clients in cycle c."""
        for i, p in enumerate(s.ports[s.users:], s.users):
            if c % p["period"] == 0: s.arrived.append((i, 0, c // p["period"] * p["stride"] % p["span"], p["bytes"], False, lambda a: None))
    def cut(s, total):
        for p in s.ports[s.users:]:
            p["requests"] = sum(c < total for c in p["arrivals"]); cols = [k for c, k in p["columns"] if c < total]; p["bursts"] = len(cols)
            for k in ("row_hits", "row_closed", "row_conflicts"): p[k] = cols.count(k)
    def waiting(s): return any(q["port"] < s.users for ch in s.channels for q in ch.queue)

class Cache:
    def __init__(s, d): s.d, s.sets, s.fill, s.answer, s.hits, s.misses, s.merged, s.looks = d, [[] for _ in range(d["sets"])], {}, 0, 0, 0, 0, []
    def settle(s):                                       # answers of look-ups come in order; fill: None for a hit, else a list that holds the answer once known
        while s.looks and s.looks[0][0] != []:
            fill, start, done = s.looks.pop(0)
            s.answer = max(s.answer, (max(fill[0], start) if fill else start) + s.d["hit_latency"]); done(s.answer)

def simulate(plan):
    fifos = {f["name"]: Fifo(f) for f in plan["fifos"]}
    mems = {m["name"]: Memory(m) for m in plan.get("memories", [])}
    port = {p["name"]: (m, i) for m in mems.values() for i, p in enumerate(m.ports)}
    caches = {k["name"]: Cache(k) for k in plan.get("caches", [])}
    units = [dict(u, free=0, steps=0, k=0, state=None, log=[], last_start=-1, block=None) for u in plan["units"]]
    later = []                                           # (cycle, what happens in it): requests and look-ups of steps under way
    pick = lambda l, i: l[i % len(l)]
    def needs(u):                                        # credits of its largest step, by port
        n = {}
        for r in u.get("requests", []): n[r["port"]] = n.get(r["port"], 0) + 1
        if "cache" in u: n[caches[u["cache"]].d["port"]] = len(u["lookups"])
        return n
    def declared(u):
        k = u["kind"]
        if k == "source" or (k == "expand" and u["state"]): return []
        if k == "merge": return [u["in"][u["k"] % len(u["in"])]]
        if k == "gate": return [u["in"][u["k"] % (u["size"] + 1) == u["size"]]]
        return u["in"]
    def finished(u): return (u["kind"] == "source" and u["k"] >= u["tokens"]) or (u["kind"] == "merge" and u["k"] >= u["tokens"])
    c, active = 0, 0
    while True:
        for m in mems.values():
            for p in m.ports:
                back = [t for t in p["returns"] if t <= c]; p["credits"] += len(back); p["returns"] = [t for t in p["returns"] if t > c]
        started = []
        for u in units:
            if u["free"] > c: u["log"].append("busy"); continue
            if u["block"] is not None:
                wait = next((p for p, ts in u["block"].items() if any(t is None or t > c for t in ts)), None)
                if wait: u["log"].append(("memory", wait)); continue
                u["block"] = None; u["released"] = c
            if finished(u): u["log"].append("idle"); continue
            ins = declared(u); lack = next((f for f in ins if not fifos[f].front(c)), None)
            if lack: u["log"].append(("starved", lack)); continue
            short = next((p for p, n in needs(u).items() if port[p][0].ports[port[p][1]]["credits"] < n), None)
            if short: u["log"].append(("memory", short)); continue
            full = next((f for f in u["out"] if not fifos[f].room(c)), None)
            if full:
                f = fifos[full]; e = f.entries[f.head - 1] if f.head and f.entries[f.head - 1]["popped"] == c else f.entries[f.head]
                rank = sorted(e["awaits"], key=lambda p: (list(mems.values()).index(port[p][0]), port[p][1]))
                wait = next((p for p in rank if any(t is None or t > c for t in e["awaits"][p])), None)
                u["log"].append(("memory", wait) if wait else ("blocked", full)); continue
            started.append(u)
        for u in started:                                # decide from the state before this cycle's pops, then act
            k, toks = u["kind"], []
            for f in declared(u):
                e = fifos[f].entries[fifos[f].head]; e["popped"] = c; fifos[f].head += 1; toks.append(e["token"])
            emit = {}
            if k == "source": t = (u["k"], u["k"] == u["tokens"] - 1); emit = {u["out"][0]: t}
            elif k == "gate": t = toks[0]; emit = {} if u["k"] % (u["size"] + 1) == u["size"] else {u["out"][0]: t}
            elif k == "tap": t = toks[0]; emit = {f: t for f in u["out"][:2 if (u["k"] + 1) % u["size"] == 0 else 1]}
            elif k in ("work", "fork", "access", "cached", "mixed"): t = toks[0]; emit = {f: t for f in u["out"]}
            elif k == "join": t = (toks[0][0], any(x[1] for x in toks)); emit = {u["out"][0]: t}
            elif k == "route": t = toks[0]; emit = {u["out"][t[0] % len(u["out"])]: t}
            elif k == "merge": t = (u["k"], u["k"] == u["tokens"] - 1); emit = {u["out"][0]: t}
            elif k == "expand":
                if toks: u["state"] = [toks[0], 0]
                (i, last), j = u["state"]; t = (i * u["factor"] + j, last and j == u["factor"] - 1)
                u["state"] = None if j == u["factor"] - 1 else [(i, last), j + 1]; emit = {u["out"][0]: t}
            elif k == "gather":
                t = toks[0]
                if t[0] % u["size"] == u["size"] - 1 or t[1]: emit = {u["out"][0]: (t[0] // u["size"], t[1])}
            else: t = toks[0]
            occ, lat, after = pick(u["occupancy"], t[0]), pick(u["latency"], t[0]), pick(u.get("after", [0]), t[0])
            if u.get("ideal"): occ, lat = 1, max(0, lat - occ + 1)
            asks = u.get("requests", []) if k != "mixed" else [r for i, r in enumerate(u["requests"]) if t[0] % pick(u["every"], i) == 0]
            looks = u.get("lookups", []) if k != "mixed" or t[0] % u["look_up_every"] == 0 else []
            awaits = {}                                      # port: answers, None while not known
            def hear(p, awaits=awaits):
                ts = awaits.setdefault(p, []); ts.append(None); i = len(ts) - 1
                def done(a): ts[i] = a
                return done
            if looks:                                        # before the requests: order of first mention
                q = caches[u["cache"]]; d = q.d; m, i = port[d["port"]]; lines = []
                for r in looks:
                    line = (t[0] * r["stride"] + r["offset"]) % r["span"] // d["line_bytes"]
                    if line not in lines: lines.append(line)
                occ = max(occ, -(-len(lines) // d["lookups_per_cycle"]))
                def look(n, line, heard, at, q=q, d=d, m=m, i=i):
                    s = q.sets[line % d["sets"]]
                    if d.get("always_hits"): q.hits += 1; m.ports[i]["credits"] += 1; q.looks.append((None, at, heard))
                    elif line in s:
                        s.remove(line); s.append(line); fill = q.fill[line]; flying = not fill or fill[0] > at
                        if flying: q.merged += 1
                        else: q.hits += 1
                        m.ports[i]["credits"] += 1; q.looks.append((fill if flying else None, at, heard))
                    else:
                        if len(s) == d["ways"]: s.pop(0)
                        s.append(line); q.misses += 1; fill = q.fill[line] = []
                        m.arrived.append((i, n, line * d["line_bytes"], d["line_bytes"], False, fill.append)); q.looks.append((fill, at, heard))
                m.ports[i]["credits"] -= len(lines)
                for n, line in enumerate(lines):
                    at = c if d.get("at_once") else c + n // d["lookups_per_cycle"]
                    later.append((at, lambda n=n, line=line, heard=hear(d["port"]), at=at, look=look: look(n, line, heard, at)))
            on = {}
            for n, r in enumerate(asks):
                m, i = port[r["port"]]; m.ports[i]["credits"] -= 1
                k_on = on[r["port"]] = on.get(r["port"], -1) + 1; issue = u.get("issue", 0)
                what = (i, n, (t[0] * r["stride"] + r["offset"]) % r["span"], r["bytes"], r["write"], (lambda a: None) if r["write"] else hear(r["port"]))
                later.append((c + (k_on // issue if issue else 0), lambda m=m, what=what: m.arrived.append(what)))
                if issue: occ = max(occ, k_on // issue + 1)
            new = []
            for f, tok in emit.items():
                e = {"token": tok, "popped": None, "reserved": c, "awaits": awaits, "after": after}; fifos[f].entries.append(e); new.append((fifos[f], e))
            for f, e in new: e["base"] = c + lat
            u["free"] = c + occ; u["released"] = c + occ; u["block"] = awaits if awaits and (pick(u["blocks"], t[0]) if k == "mixed" else u.get("blocking")) else None; u["steps"] += 1; u["k"] += 1; u["last_start"] = c; u["log"].append("busy"); active = max(active, u["free"] - 1)
        for x in [x for x in later if x[0] == c]: x[1]()
        later = [x for x in later if x[0] > c]
        for m in mems.values(): m.tick(c); m.serve(c)
        for q in caches.values(): q.settle()
        for f in fifos.values():                          # a token's time is known when its answers are, and those of the tokens ahead
            while f.settled < len(f.entries):
                e = f.entries[f.settled]; ts = [t for x in e["awaits"].values() for t in x]
                if None in ts: break
                e["visible"] = max(max([e["base"]] + [x + e["after"] for x in ts]) + f.latency, f.last_visible + 1); e["visible"] = -(-e["visible"] // f.period) * f.period; f.last_visible = e["visible"]; f.settled += 1; active = max(active, e["visible"])
        for f in fifos.values():
            f.__dict__.setdefault("log", []).append(f.held(c))
        events = [u["free"] for u in units] + [x[0] for x in later] + [t for u in units if u["block"] for ts in u["block"].values() for t in ts if t is not None] + [t for m in mems.values() for p in m.ports[:m.users] for t in p["returns"]] + [e["visible"] for f in fifos.values() for e in f.entries[f.head:f.settled]]
        if not started and not any(t > c for t in events) and not any(m.waiting() for m in mems.values()): break
        c += 1
        if c > 2_000_000: raise SystemExit("plan runs too long")
    active = max([active] + [m.last_data for m in mems.values()]); total = active + 1
    for m in mems.values(): m.cut(total)
    res = {"outcome": "complete", "total": total, "units": {}, "fifos": {}, "memories": {}, "caches": {}}
    stuck = any(u["kind"] in ("source", "merge") and u["k"] < u["tokens"] or u["state"] for u in units) or any(f.head < len(f.entries) for f in fifos.values())
    if stuck: res["outcome"] = "deadlock"
    for u in units:
        log = (u["log"] + ["idle"] * total)[:total]; end = u["released"] if u["steps"] else 0
        r = {"steps": u["steps"], "busy": 0, "done": 0, "starved": {}, "memory": {}, "blocked": {}}
        for i, x in enumerate(log):
            if x == "busy": r["busy"] += 1
            elif x == "idle" or (i >= end and u["steps"] and not stuck): r["done"] += 1
            else: r[x[0]][x[1]] = r[x[0]].get(x[1], 0) + 1
        res["units"][u["name"]] = r
    for n, f in fifos.items():
        h = [0] * (f.depth + 1)
        for x in (f.log + [0] * total)[:total] if len(f.log) >= total else f.log + [f.log[-1]] * (total - len(f.log)): h[x] += 1
        res["fifos"][n] = h
    for n, m in mems.items(): res["memories"][n] = {p["name"]: {k: p[k] for k in ("requests", "bursts", "row_hits", "row_closed", "row_conflicts")} for p in m.ports}
    for n, q in caches.items(): res["caches"][n] = {"hits": q.hits, "misses": q.misses, "merged": q.merged}
    return res

def make(seed):
    r = random.Random(seed); plan = {"fifos": [], "memories": [], "caches": [], "units": []}
    few = lambda lo, hi: [r.randint(lo, hi) for _ in range(r.randint(1, 3))]
    def fifo(): plan["fifos"].append(dict({"name": "f%d" % len(plan["fifos"]), "depth": r.choice([1, 1, 2, 3, 4, 8]), "latency": r.choice([1, 1, 1, 2, 3])}, **({"period": r.randint(2, 20)} if r.random() < .1 else {}))); return plan["fifos"][-1]["name"]
    def unit(kind, i, o, **x): plan["units"].append(dict({"name": "u%d" % len(plan["units"]), "kind": kind, "in": i, "out": o, "occupancy": few(1, 4), "latency": few(0, 6)}, **x, **({"ideal": True} if r.random() < .05 else {})))
    for k in range(r.choice([0, 1, 1, 2, 2])):
        plan["memories"].append({"name": "m%d" % k, "burst_bytes": 32, "burst_cycles": r.randint(1, 4), "banks": r.choice([1, 2, 4]), "row_bytes": r.choice([64, 256]), "channels": r.choice([1, 1, 2, 3]), "channel_bytes": r.choice([32, 64, 256]), "window": r.choice([1, 2, 4, 16]), "cap": r.choice([0, 1, 4, 16]),
                                 "cl": r.randint(0, 4), "cwl": r.randint(0, 3), "rcd": r.randint(0, 4), "rp": r.randint(0, 4), "ras": r.randint(0, 9), "rtp": r.randint(0, 3), "wr": r.randint(0, 4), "wtr": r.randint(0, 3),
                                 "rrd": r.randint(0, 3), "faw": r.randint(0, 12), **({"commands_per_cycle": r.randint(1, 2)} if r.random() < .3 else {}), **r.choice([{"refi": 0, "rfc": 0}, {"refi": 100, "rfc": r.randint(1, 20)}]), "ports": []})
        if r.random() < .4:
            m, n = plan["memories"][-1], r.randint(1, 2); m["periodic"] = []
            for j in range(n):                               # less than the memory can serve, or units would wait longer and longer
                size = r.choice([32, 64, 96]); least = n * (size // 32 + 1) * (m["burst_cycles"] + m["cl"] + m["rp"] + m["rcd"] + m["ras"] + m["wtr"] + m["wr"])
                m["periodic"].append({"name": "m%dv%d" % (k, j), "period": least + r.randint(0, 40), "bytes": size, "stride": r.choice([32, 64, 96]), "span": 1024})
    def extra(): return dict(**({"after": few(0, 5)} if r.random() < .5 else {}), **({"blocking": True} if r.random() < .4 else {}))
    def port(least, flips=False):
        m = r.choice(plan["memories"]); m["ports"].append({"name": "%sp%d" % (m["name"], len(m["ports"])), "outstanding": least + r.randint(0, 4)})
        if flips and m.get("periodic") and r.random() < .7:
            held = [p["flips"]["of"] for p in m["ports"] if p.get("flips", {}).get("hold")]        # a wait is of use where another port holds
            m["ports"][-1]["flips"] = {"of": r.choice(held), "period": 1, "hold": 0, "wait": True} if held and r.random() < .6 else {"of": r.choice(m["periodic"])["name"], "period": r.randint(1, 60), "hold": r.choice([0, 7, 40]), **({"wait": True} if r.random() < .1 else {})}
        return m["ports"][-1]["name"]
    def lookups(): return [{"stride": r.choice([4, 16, 40]), "offset": r.randint(0, 200), "span": 512} for _ in range(r.randint(1, 3))]
    n = r.randint(4, 24); a = fifo(); unit("source", [], [a], tokens=n)
    def cache(looks): plan["caches"].append({"name": "c%d" % len(plan["caches"]), "port": port(looks), "line_bytes": 32, "sets": r.choice([1, 2, 4]), "ways": r.choice([1, 2]), "hit_latency": r.randint(0, 3), "lookups_per_cycle": r.randint(1, 2), **({"at_once": True} if r.random() < .3 else {}), **({"always_hits": True} if r.random() < .1 else {})}); return plan["caches"][-1]["name"]
    kinds = [r.choice(["work", "work", "fork", "route", "expand", "gather", "access", "cached", "mixed", "gate"]) for _ in range(r.randint(1, 6))]
    while kinds:
        k = kinds.pop(0)
        if k in ("access", "cached", "mixed") and not plan["memories"]: k = "work"
        b = fifo()
        if k == "gate":                                      # a loop: what is between gate and tap passes each token on
            back, x = fifo(), r.randint(1, 4); unit("gate", [a, back], [b], size=x)
            kinds[:0] = [r.choice(["work", "access", "cached", "mixed"]) for _ in range(r.randint(0, 2))] + [("tap", back, x)]
        elif isinstance(k, tuple): unit("tap", [a], [b, k[1]], size=k[2])
        elif k == "work": unit("work", [a], [b])
        elif k == "expand": x = r.randint(2, 3); unit("expand", [a], [b], factor=x); n *= x
        elif k == "gather": x = r.randint(2, 4); unit("gather", [a], [b], size=x); n = -(-n // x)
        elif k == "access":
            p, q = port(2, True), r.random() < .4; reqs = [{"port": p, "write": False, "bytes": r.choice([4, 32, 64]), "stride": r.choice([4, 32, 96, 260]), "offset": r.randint(0, 64), "span": 1024}]
            if q: reqs.append({"port": p, "write": True, "bytes": 32, "stride": 64, "offset": 512, "span": 1024})
            if r.random() < .3: reqs += [dict(reqs[0], offset=r.randint(64, 900)) for _ in range(r.randint(1, 2))]; next(x for x in plan["memories"][int(p[1])]["ports"] if x["name"] == p)["outstanding"] += 2
            if r.random() < .3: reqs.insert(r.randint(0, len(reqs)), dict(reqs[0], port=port(1), offset=r.randint(64, 900)))
            unit("access", [a], [b], requests=reqs, **extra(), **({"issue": r.randint(1, 2)} if r.random() < .5 else {}))
        elif k == "cached":
            unit("cached", [a], [b], lookups=lookups(), cache=cache(3), **extra())
        elif k == "mixed":
            p, q = port(2), port(1, True); req = lambda p, write: {"port": p, "write": write, "bytes": r.choice([4, 32, 64]), "stride": r.choice([4, 32, 96]), "offset": r.randint(0, 900), "span": 1024}
            unit("mixed", [a], [b], requests=[req(p, False), req(q, r.random() < .5), req(p, True)], every=[r.randint(1, 4) for _ in range(3)], lookups=lookups(), look_up_every=r.randint(1, 3), cache=cache(3),
                 blocks=[r.random() < .5 for _ in range(r.randint(1, 3))], **({"after": few(0, 5)} if r.random() < .5 else {}), **({"issue": r.randint(1, 2)} if r.random() < .5 else {}))
        else:
            w = r.randint(2, 3); xs, ys = [fifo() for _ in range(w)], [fifo() for _ in range(w)]
            unit(k, [a], xs)
            size = next((q for q in (4, 3, 2) if n % q == 0), 0)
            for i, (x, y) in enumerate(zip(xs, ys)):
                if k == "fork" and size and i == 0 and r.random() < .5:      # one branch works in batches: shallow neighbours deadlock
                    mid = fifo(); unit("gather", [x], [mid], size=size); unit("expand", [mid], [y], factor=size)
                else: unit("work", [x], [y])
            unit("join" if k == "fork" else "merge", ys, [b], **({} if k == "fork" else {"tokens": n}))
        a = b
    unit("sink", [a], [])
    r.shuffle(plan["units"])
    return plan

if __name__ == "__main__":
    if sys.argv[1:2] == ["run"]: print(json.dumps(simulate(json.load(open(sys.argv[2]))), sort_keys=True))
    elif sys.argv[1:2] == ["make"]:
        import os
        seed, n, out = int(sys.argv[2]), int(sys.argv[3]) if len(sys.argv) > 4 else 1, sys.argv[-1]
        os.makedirs(out, exist_ok=True)
        for s in range(seed, seed + n):
            plan = make(s); json.dump({"plan": plan, "result": simulate(plan)}, open(os.path.join(out, "%d.json" % s), "w"), sort_keys=True)
    else: print(__doc__)
