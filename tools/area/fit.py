#!/usr/bin/env python3
"""Fits one formula per kind of block to area.csv by least squares of relative errors. Prints coefficients and errors."""
import csv, math, pathlib, sys

HERE = pathlib.Path(__file__).resolve().parent
l2 = lambda n: max(1, math.ceil(math.log2(n)))
def least_squares(x, y):
    """Coefficients c that make the relative errors of x c against y small, by normal equations."""
    x = [[v / b for v in a] for a, b in zip(x, y)]; n = len(x[0])
    m = [[sum(r[i] * r[j] for r in x) for j in range(n)] + [sum(r[i] for r in x)] for i in range(n)]
    for i in range(n):
        p = max(range(i, n), key=lambda r: abs(m[r][i])); m[i], m[p] = m[p], m[i]
        for r in range(n):
            if r != i:
                f = m[r][i] / m[i][i]; m[r] = [a - f * b for a, b in zip(m[r], m[i])]
    return [m[i][n] / m[i][i] for i in range(n)]

# block: (blocks measured, names of the terms, terms of the parameters)
FITS = {
    "multiplier, signed (w >= v)": (["mul_s"], "w*(v-1), v", lambda p: [p["W"] * (p["V"] - 1), p["V"]]),
    "multiplier, unsigned": (["mul_u"], "w*(v-1), v", lambda p: [p["W"] * (p["V"] - 1), p["V"]]),
    "upper half of product": (["mul_h"], "w*w, w", lambda p: [p["W"] ** 2, p["W"]]),
    "adder": (["add", "sub"], "w, 1", lambda p: [p["W"], 1]),
    "adder-subtracter": (["addsub"], "w, 1", lambda p: [p["W"], 1]),
    "incrementer": (["inc"], "w, 1", lambda p: [p["W"], 1]),
    "comparator <": (["lt_u", "lt_s"], "w, 1", lambda p: [p["W"], 1]),
    "comparator =": (["eq"], "w", lambda p: [p["W"]]),
    "larger of two": (["max2"], "w", lambda p: [p["W"]]),
    "max tree": (["max_tree"], "w*(n-1)", lambda p: [p["W"] * (p["N"] - 1)]),
    "shifter": (["shr", "sra"], "w*log2 w", lambda p: [p["W"] * p["S"]]),
    "multiplexer": (["mux"], "w*(n-1), n", lambda p: [p["W"] * (p["N"] - 1), p["N"]]),
    "AND-OR, decoded": (["onehot_mux"], "w*n", lambda p: [p["W"] * p["N"]]),
    "first of n": (["prio"], "n, 1", lambda p: [p["N"], 1]),
    "register": (["dff"], "w", lambda p: [p["W"]]),
    "register, enable": (["dffe"], "w", lambda p: [p["W"]]),
    "register, reset": (["dffr"], "w", lambda p: [p["W"]]),
    "FIFO control": (["fifo_control"], "1, log2 d", lambda p: [1, p["A"]]),
    "register file, 1 write": (["regfile"], "bits, bits*r, d", lambda p: [p["D"] * p["W"], p["D"] * p["W"] * p["R"], p["D"]]),
    "register file, p writes": (["regfile_w"], "bits, bits*p, d*p", lambda p: [p["D"] * p["W"], p["D"] * p["W"] * p["P"], p["D"] * p["P"]]),
    "tag compare": (["tagcmp"], "n*t, n*l", lambda p: [p["N"] * p["T"], p["N"] * p.get("L", 1)]),
    "LRU of a set": (["lru"], "n*log2 n, n", lambda p: [p["N"] * p["B"], p["N"]]),
    "divider": (["div_seq"], "w, w*k", lambda p: [p["W"], p["W"] * p["K"]]),
    "root, at once": (["sqrt_comb"], "w*w, w", lambda p: [p["W"] ** 2, p["W"]]),
    "root": (["sqrt_seq"], "w, w*k", lambda p: [p["W"], p["W"] * p["K"]]),
    "float multiplier": (["fmul"], "m*m, m", lambda p: [(p["M"] + 1) ** 2, p["M"] + 1]),
    "float adder": (["fadd"], "m*log2 m, m", lambda p: [(p["M"] + 1) * p["S"], p["M"] + 1]),
    "inner product": (["dot3"], "w*w, w", lambda p: [p["W"] ** 2, p["W"]]),
    "power, 16 bits": (["power"], "1, entries", lambda p: [1, 2 ** p["A"]]),
    "power, 16 bits, by digits": (["power_seq"], "1, k", lambda p: [1, p["K"]]),
}

def main():
    rows = [r | {k: int(v) for k, v in (x.split("=") for x in r["parameters"].split())} for r in csv.DictReader(open(sys.argv[1] if len(sys.argv) > 1 else HERE / "area.csv"))]
    print("| kind | terms | by library: coefficients | max % | mean % | generic: coefficients | max % | mean % | points | levels |\n|---|---|---|---|---|---|---|---|---|---|")
    for kind, (blocks, names, terms) in FITS.items():
        of = [r for r in rows if r["block"] in blocks]
        if not of: continue
        line = f"| {kind} | {names} "
        for column in ("ge_lib", "ge_generic"):
            x, y = [terms(r) for r in of], [float(r[column]) for r in of]
            c = least_squares(x, y); e = [abs(sum(map(float.__mul__, c, map(float, a))) / b - 1) * 100 for a, b in zip(x, y)]
            line += f"| {', '.join(f'{v:.2f}' for v in c)} | {max(e):.0f} | {sum(e) / len(e):.0f} "
        print(line + f"| {len(of)} | {min(int(r['levels']) for r in of)}..{max(int(r['levels']) for r in of)} |")

if __name__ == "__main__": main()
