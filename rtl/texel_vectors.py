"""Synthetic vectors of units of the texel value generator."""

from floats import double_bits, double_of
from recording import value
from synthetic import TOKENS, Synthetic, token

CRITERION = 5


def step_calculator(base, seed):
    """Returns vectors of the step calculator: short spans, spans at the bound, W that rises, falls and stays, and selected criteria. The far end
    of each segment is random, because it passes through the twin."""
    made = Synthetic(base, "step-calculator", seed)
    fields, (out, points), rng = made.fields["spans"], (made.fields[name] for name in ("segments", "points")), made.random
    tokens, spans = [], {}
    for _ in range(TOKENS // 2):
        if rng.random() < 0.2:
            kind = rng.choice([0, 2, 4, CRITERION, CRITERION])
            tokens.append(token(fields, kind=kind, **(dict(criterion=double_bits(rng.uniform(0.01, 3.0))) if kind == CRITERION else {})))
            continue
        pixels = rng.choice([1, 2, 3, rng.randint(4, 60), rng.randint(60, 900)])
        first, last = (2.0 ** rng.uniform(-8, 4) for _ in range(2))
        last = rng.choice([first, last, last, first * (1 + 2.0 ** rng.uniform(-20, -1)), first * (1 - 2.0 ** rng.uniform(-20, -1))])
        step = (last - first) / max(pixels - 1, 1)
        textured = int(rng.random() < 0.9)
        w = dict(first_w=double_bits(first), last_w=double_bits(last), step_w=double_bits(step))
        # Control has a field of the same name; this one is the last.
        at = max(number for name, number, _ in fields if name == "textured")
        tokens.append(token(fields, item=1, pixels=pixels, x=rng.getrandbits(12), **w) | textured << at)
        spans[tokens[-1]] = first, last, step, pixels, textured
    numbers = {name: base.number(made.only, name) for name in ("latency", "decision", "quotient", "root", "first", "next")}
    span_fields = [name for name, *_ in out if name.startswith("span_")]
    start, end = (next(number for name, number, _ in of if name == wanted) for of, wanted in ((out, "span_first_u"), (fields, "first_u")))
    size = sum(bits for name, _, bits in out if name in span_fields)
    e = double_of(base.number(made.only, "criterion"))

    def keeps(first, last, t):
        """Returns true if the bound holds for a segment of this length."""
        less, more = t - e, t + e
        return less <= 0 or max(first, last) * (less * less) <= min(first, last) * (more * more)

    def steps(bits):
        nonlocal e
        if not bits & 1:
            if value(bits, fields, "kind") == CRITERION:
                e = double_of(value(bits, fields, "criterion"))
            given = token(out, kind=value(bits, fields, "kind"), criterion=value(bits, fields, "criterion"))
            yield 1, numbers["latency"], {0: given, 1: given}
            return
        first, last, step, pixels, textured = spans[bits]
        cycles, is_divided, at, far = 0, False, 0, pixels - 1
        if textured and pixels > base.config["texel"]["min_span"]:
            is_divided = not keeps(first, last, float(far))
            cycles = numbers["decision"] - 1 + numbers["quotient"] * is_divided
        while True:
            to, turn = far, 1
            if is_divided:
                w = last if at >= far and at else first + float(at) * step
                is_free = step == 0 or (step < 0 and w <= e * -step)
                turn = numbers["next" if at else "first"] + (0 if is_free else numbers["root"])
                to = far if is_free else rng.randint(at + 1, far)
            segment = token(out, item=1, to=to, walk=to - at + (to == far), fresh=int(at == 0), **{"from": at})
            segment |= (bits >> end & (1 << size) - 1) << start
            cycles += turn
            yield cycles, numbers["latency"] + cycles - 1, {0: segment, 1: token(points, item=1) | rng.getrandbits(100) << 1}
            if to == far:
                return
            at, cycles = to, 0

    return made.generate(tokens, steps)
