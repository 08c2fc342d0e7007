"""A machine in Python: how many search lanes does the replacement unit need?

    pip install ./crates/python
    python examples/machine.py
"""
import basrelief

scene = basrelief.demo("golf-ball", size=(160, 120))
print("lanes   cycles  replacement busy")
for lanes in (16, 64, 256):
    machine = basrelief.Machine("bump", **{"replacement.lanes": lanes})
    result = machine.run(scene)
    busy = dict(zip(result.units["unit"], result.units["busy"]))
    print(f"{lanes:5} {result.cycles:8,} {busy['replacement'] / result.cycles:17.0%}")
