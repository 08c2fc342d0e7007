#!/usr/bin/env python3
"""Share of the hypervolume that other searches find on grids that were swept as a whole. Needs numpy, scipy and optuna.

    exploration.py METHOD SEEDS GRID.csv...      METHOD: random, sobol or tpe

Each line is a grid, its points, and the mean share [%] over seeds with 5, 8, 12, 20, 30 and 50 % of the points.
`cargo run --release -p basrelief-dse --example explored` prints the same for `basrelief explore`.
"""
import math
import os
import sys
import warnings

import numpy as np

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "../tests/oracles"))
from exploration import Grid, boxes, nondominated

PERCENT = (5, 8, 12, 20, 30, 50)


def volume(costs):
    """Share of the unit cube that these costs dominate."""
    front = [p for p in nondominated(costs) if max(p) < 1]
    free = sum(math.prod(high - max(low, 0) for low, high in box) for box in boxes(front, costs.shape[1]))
    return 1 - free


class Space:
    def __init__(self, grid):
        self.grid, costs = grid, grid.costs[grid.ran]
        self.low = costs.min(0)
        extent = 1.1 * (costs.max(0) - self.low)
        self.used = extent > 0
        self.extent = np.where(self.used, extent, 1)
        self.all = self.volume(np.flatnonzero(grid.ran))

    def volume(self, points):
        points = [p for p in points if self.grid.ran[p]]
        costs = (self.grid.costs[points] - self.low) / self.extent
        return volume(costs[:, self.used]) if points else 0.0

    def share(self, points):
        return 100 * self.volume(points) / self.all


def random(grid, seed, budget):
    return list(np.random.default_rng(seed).permutation(len(grid.costs))[:budget])


def sobol(grid, seed, budget):
    from scipy.stats import qmc

    sampler, seen = qmc.Sobol(len(grid.lengths), seed=seed), {}
    while len(seen) < budget:
        for row in sampler.random(64):
            places = [min(int(x * n), n - 1) for x, n in zip(row, grid.lengths)]
            seen.setdefault(int(np.ravel_multi_index(places, grid.lengths)))
    return list(seen)[:budget]


def tpe(grid, seed, budget):
    import optuna

    optuna.logging.set_verbosity(optuna.logging.ERROR)
    warnings.filterwarnings("ignore")
    sampler = optuna.samplers.TPESampler(seed=seed, multivariate=True)
    study = optuna.create_study(directions=["minimize"] * grid.costs.shape[1], sampler=sampler)
    seen, trials = {}, 0
    # A point that was proposed before costs nothing.
    while len(seen) < budget and trials < 12 * budget:
        trial, trials = study.ask(), trials + 1
        places = [trial.suggest_int(str(j), 0, n - 1) for j, n in enumerate(grid.lengths)]
        point = int(np.ravel_multi_index(places, grid.lengths))
        seen.setdefault(point)
        if grid.ran[point]:
            study.tell(trial, [float(c) for c in grid.costs[point]])
        else:
            study.tell(trial, state=optuna.trial.TrialState.FAIL)
    return list(seen)


def main():
    methods = {"random": random, "sobol": sobol, "tpe": tpe}
    if len(sys.argv) < 4 or sys.argv[1] not in methods:
        sys.exit(__doc__)
    method, seeds = methods[sys.argv[1]], int(sys.argv[2])
    print("grid,points," + ",".join(f"{p} %" for p in PERCENT))
    for path in sys.argv[3:]:
        grid = Grid(path)
        space, points = Space(grid), len(grid.costs)
        budgets = [max(4, (points * p + 50) // 100) for p in PERCENT]
        orders = [method(grid, seed, budgets[-1]) for seed in range(seeds)]
        shares = [np.mean([space.share(order[:b]) for order in orders]) for b in budgets]
        print(path, points, *[f"{share:.2f}" for share in shares], sep=",", flush=True)


if __name__ == "__main__":
    main()
