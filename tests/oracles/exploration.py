#!/usr/bin/env python3
"""The search of `basrelief explore`, written independently with numpy. A test of the crate dse compares the choices of both.

    exploration.py orders SHARE GRID.csv...      prints the choices on each grid as CSV: grid, points in the order of choice

A grid is a CSV file with all points: columns `axis NAME`, then `min NAME` or `max NAME` for objectives, empty for a point that failed.
Hardware and bytes of memory are taken as known without a run.
"""
import csv
import itertools
import math
import os
import sys

import numpy as np

LENGTHS = [2.0**e for e in range(-3, 5)]  # of an axis, whose values lie from 0 to 1
NUGGET, PRIOR, TUNED, AGAIN, SCREEN, MOST = 1e-6, 0.1, 120, 1.2, 512, 8


class Grid:
    """All points of a plan with their costs; the last axis changes fastest."""

    def __init__(self, path):
        with open(path, newline="") as file:
            head, *rows = csv.reader(file)
        axes = [i for i, name in enumerate(head) if name.startswith("axis ")]
        objectives = [i for i in range(len(head)) if i not in axes]
        values, self.categorical = zip(*[values_of([row[i] for row in rows]) for i in axes])
        self.lengths = [len(v) for v in values]
        points = list(np.ndindex(*self.lengths))
        place = {point: number for number, point in enumerate(points)}
        self.costs = np.full((len(points), len(objectives)), np.nan)
        for row in rows:
            number = place[tuple(v.index(row[i]) for v, i in zip(values, axes))]
            if all(row[i] for i in objectives):
                self.costs[number] = [float(row[i]) * (1 if head[i].startswith("min ") else -1) for i in objectives]
        self.ran = np.isfinite(self.costs).all(1)
        # A failed point has the known cost of the nearest point that ran.
        places, good = np.array(points), np.flatnonzero(self.ran)
        nearest = lambda p: good[np.abs(places[good] - places[p]).sum(1).argmin()]
        filled = np.array([self.costs[p if self.ran[p] else nearest(p)] for p in range(len(points))])
        known = [k for k, i in enumerate(objectives) if "hardware" in head[i] or "memories.bytes" in head[i]]
        self.exact = {k: filled[:, k] for k in known}

    def run(self, point):
        return self.costs[point] if self.ran[point] else None


def values_of(column):
    """The values of an axis in order, and whether they are categories."""
    seen = list(dict.fromkeys(column))
    try:
        return [v for _, v in sorted((float(v.split("+")[0]), v) for v in seen)], False
    except ValueError:
        return seen, len(seen) > 2


class Model:
    """One objective: Gaussian process on places; squared exponential along each axis; a table of correlations per axis."""

    def __init__(self, axes, categorical):
        self.axes, self.categorical, self.lengths, self.tuned = axes, categorical, None, 0

    def tables(self, lengths):
        def correlation(j, a, b):
            d = float(a != b) if self.categorical[j] else abs(a - b) / max(1, self.axes[j] - 1)
            return math.exp(-0.5 * (d / lengths[j]) ** 2)

        return [np.array([[correlation(j, a, b) for b in range(n)] for a in range(n)]) for j, n in enumerate(self.axes)]

    @staticmethod
    def correlation(a, b, tables):
        k = np.ones((len(a), len(b)))
        for j, table in enumerate(tables):
            k *= table[a[:, j][:, None], b[:, j][None]]
        return k

    def solve(self, x, y, lengths):
        tables = self.tables(lengths)
        factor = np.linalg.cholesky(self.correlation(x, x, tables) + NUGGET * np.eye(len(y)))
        a, b = np.linalg.solve(factor, y), np.linalg.solve(factor, np.ones(len(y)))
        mean = (a @ b) / (b @ b)
        r = a - mean * b
        return tables, factor, mean, r, (r @ r + 2.0) / (len(y) + 2.0)  # as if two more of variance one had been seen

    def misfit(self, x, y, lengths):
        try:
            _, factor, _, _, variance = self.solve(x, y, lengths)
        except np.linalg.LinAlgError:
            return math.inf
        likelihood = 0.5 * (len(y) + 2) * math.log(variance) + np.log(np.diag(factor)).sum()
        return likelihood + PRIOR * sum(math.log(length) ** 2 for length in lengths)

    def tune(self, x, y):
        if self.lengths and len(y) < AGAIN * self.tuned:
            return
        self.tuned = len(y)
        x, y = x[-TUNED:], y[-TUNED:]
        isotropic = ([length] * len(self.axes) for length in LENGTHS)
        best = self.lengths or min(isotropic, key=lambda lengths: self.misfit(x, y, lengths))
        least = self.misfit(x, y, best)
        for _ in range(3):
            before = least
            for j, step in itertools.product(range(len(best)), (2.0, 0.5)):
                moved = best[:j] + [best[j] * step] + best[j + 1 :]
                if LENGTHS[0] <= moved[j] <= LENGTHS[-1]:
                    value = self.misfit(x, y, moved)
                    if value < least - 1e-9:
                        least, best = value, moved
            if least == before:
                break
        self.lengths = best

    def fit(self, x, y, tune):
        self.offset, self.unit = y.mean(), y.std() or 1.0
        y = (y - self.offset) / self.unit
        if tune:
            self.tune(x, y)
        self.x = x
        self.t, self.factor, self.mean, r, self.variance = self.solve(x, y, self.lengths)
        self.weights = np.linalg.solve(self.factor.T, r)

    def means(self, grid):
        """Mean of each point, and its deviation if only the nearest point were known: no less than that of `deviations`."""
        k = self.correlation(grid, self.x, self.t)
        deviation = np.sqrt(np.maximum(self.variance * (1 - k.max(1) ** 2), 0))
        return (self.mean + k @ self.weights) * self.unit + self.offset, deviation * self.unit

    def deviations(self, grid):
        v = np.linalg.solve(self.factor, self.correlation(grid, self.x, self.t).T)
        return np.sqrt(np.maximum(self.variance * (1 - (v * v).sum(0)), 0)) * self.unit


def nondominated(costs):
    front = []
    for point in sorted(set(map(tuple, costs))):
        if not any(all(a <= b for a, b in zip(other, point)) for other in front):
            front.append(point)
    return front


def boxes(front, objectives):
    """The region below 1 that no point of the front dominates, as disjoint boxes: (low, high) per objective."""
    if objectives == 1:
        return [[(-math.inf, min([point[0] for point in front] + [1.0]))]]
    last, low, found = objectives - 1, -math.inf, []
    for high in sorted({point[last] for point in front if point[last] < 1}) + [1.0]:
        below = [point[:last] for point in front if point[last] <= low]
        found += [box + [(low, high)] for box in boxes(below, last)]
        low = high
    return found


erfc = np.vectorize(math.erfc)


def below(limit, mean, deviation, logarithmic, low, extent):
    """E[(limit - cost)+], cost = (exp(z) or z, less low) / extent, z normal."""
    if limit == -math.inf:
        return np.zeros(len(mean))
    limit, s = limit * extent + low, np.maximum(deviation, 1e-12)
    with np.errstate(all="ignore"):
        if logarithmic:
            d = (math.log(limit) - mean) / s if limit > 0 else np.full(len(mean), -40.0)
            e = limit * 0.5 * erfc(-d / 2**0.5) - np.exp(mean + s * s / 2) * 0.5 * erfc(-(d - s) / 2**0.5)
        else:
            d = (limit - mean) / s
            e = (limit - mean) * 0.5 * erfc(-d / 2**0.5) + s * np.exp(-d * d / 2) / math.sqrt(2 * math.pi)
    return np.maximum(e, 0) / extent


def gains(front, means, deviations, logarithmic, low, extent):
    """Exact expected growth of the hypervolume, objectives independent: a sum of products over boxes."""
    cache = {}

    def e(k, limit):
        if (k, limit) not in cache:
            cache[k, limit] = below(limit, means[:, k], deviations[:, k], logarithmic[k], low[k], extent[k])
        return cache[k, limit]

    objectives = range(means.shape[1])
    return sum(math.prod(e(k, box[k][1]) - e(k, box[k][0]) for k in objectives) for box in boxes(front, means.shape[1]))


def farthest(grid, axes, free, order):
    far = np.abs(grid[:, None] - grid[order][None]) / np.maximum(1, np.array(axes) - 1)
    return int(np.argmax(np.where(free, far.sum(2).min(1), -1)))


def chances(grid, axes, categorical, order, ran):
    """Chance that a point runs: inverse cubes of distances to those that did and did not."""
    distance = np.zeros((len(grid), len(order)))
    for j, n in enumerate(axes):
        d = np.abs(grid[:, j][:, None] - grid[order, j][None])
        distance += (d > 0) if categorical[j] else d / max(1, n - 1)
    weight = 1 / np.maximum(distance, 1e-9) ** 3
    return np.clip(weight @ ran / weight.sum(1), 0.01, 1)


def search(axes, categorical, run, budget, exact):
    """run(point) returns costs or None. exact: {objective: cost of every point} where known without a run."""
    grid = np.array(list(np.ndindex(*axes)))
    n, free, order, costs, models = len(grid), np.ones(len(grid), bool), [], {}, {}

    def take(point):
        free[point] = False
        order.append(point)
        costs[point] = run(point)

    known = exact[min(exact)] if exact else np.arange(n)
    for point in (int(np.argmin(known)), int(n - 1 - np.argmax(known[::-1]))):
        if free[point] and len(order) < budget:
            take(point)
    while len(order) < min(budget, n):
        size = min(MOST, max(1, len(order) // 4), budget - len(order))
        ran = [p for p in order if costs[p] is not None]
        if len(ran) < 2:
            take(farthest(grid, axes, free, order))
            continue
        y_all = np.array([costs[p] for p in ran], float)
        m = y_all.shape[1]
        low = np.array([exact[k].min() if k in exact else y_all[:, k].min() for k in range(m)])
        high = np.array([exact[k].max() if k in exact else y_all[:, k].max() for k in range(m)])
        used = [k for k in range(m) if high[k] > low[k]] or [0]
        extent = np.where(high > low, 1.1 * (high - low), 1.1)
        logarithmic = [y_all[:, k].min() > 0 for k in range(m)]
        learned = [k for k in used if k not in exact and np.ptp(y_all[:, k]) > 0]
        x = grid[ran]
        y = {k: np.log(y_all[:, k]) if logarithmic[k] else y_all[:, k].copy() for k in learned}
        mean, deviation = np.zeros((n, m)), np.zeros((n, m))
        for k in used:
            c = exact[k] if k in exact else np.full(n, y_all[0, k])
            mean[:, k] = np.log(c) if logarithmic[k] else c
        chance = np.ones(n)
        if len(ran) < len(order):
            chance = chances(grid, axes, categorical, order, np.array([costs[p] is not None for p in order], float))
        front = [tuple(v) for v in ((y_all - low) / extent)[:, used]]
        scales = ([logarithmic[k] for k in used], low[used], extent[used])
        picked = []
        for turn in range(size):
            for k in learned:
                models.setdefault(k, Model(axes, categorical)).fit(x, y[k], turn == 0)
                mean[:, k], deviation[:, k] = models[k].means(grid)
            front = [p for p in nondominated(front) if max(p) < 1]
            c = np.flatnonzero(free)
            if not len(c):
                break
            bound = gains(front, mean[np.ix_(c, used)], deviation[np.ix_(c, used)], *scales) * chance[c]
            c = c[np.argsort(-bound, kind="stable")[:SCREEN]]
            for k in learned:
                deviation[c, k] = models[k].deviations(grid[c])
            g = gains(front, mean[np.ix_(c, used)], deviation[np.ix_(c, used)], *scales) * chance[c]
            p = int(c[np.argmax(g)]) if g.max() > 1e-15 else int(c[np.argmax(deviation[c].sum(1) * chance[c])])
            picked.append(p)
            free[p] = False
            # Until it has run, the mean is believed.
            x = np.vstack([x, grid[p]])
            y = {k: np.append(y[k], mean[p, k]) for k in learned}
            cost = np.array([math.exp(min(mean[p, k], 700)) if logarithmic[k] else mean[p, k] for k in used])
            front.append(tuple((cost - low[used]) / extent[used]))
        for p in picked:
            order.append(p)
            costs[p] = run(p)
    return order


def main():
    if len(sys.argv) < 4 or sys.argv[1] != "orders":
        sys.exit(__doc__)
    print("grid,order")
    for path in sys.argv[3:]:
        grid = Grid(path)
        budget = max(4, round(len(grid.costs) * float(sys.argv[2])))
        order = search(grid.lengths, grid.categorical, grid.run, budget, grid.exact)
        print(os.path.splitext(os.path.basename(path))[0], " ".join(map(str, order)), sep=",", flush=True)


if __name__ == "__main__":
    main()
