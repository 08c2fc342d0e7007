"""A custom cost report from report.json: the units in order of busy cycles, priced by your own rule.

    basrelief demo --size 160x120 --out out/ball
    python examples/cost_report.py out/ball/report.json
"""
import json
import sys

PICOJOULES_PER_BUSY_CYCLE = 12.0  # your own figure per unit and cycle
PICOJOULES_PER_BYTE = 40.0  # your own figure for external memory

with open(sys.argv[1]) as file:
    report = json.load(file)

units = sorted(report["units"].items(), key=lambda unit: -unit[1]["busy"])
print(f"{'unit':20} {'busy cycles':>12} {'energy in nJ':>13}")
for name, unit in units:
    print(f"{name:20} {unit['busy']:12,} {unit['busy'] * PICOJOULES_PER_BUSY_CYCLE / 1000:13,.1f}")

moved = sum(
    client["read_bytes"] + client["write_bytes"]
    for memory in report["memories"].values()
    for client in memory["clients"].values()
)
print(f"{'external memory':20} {moved:6,} bytes {moved * PICOJOULES_PER_BYTE / 1000:13,.1f}")
