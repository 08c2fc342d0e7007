"""A trace by hand: two grey triangles as a display list in JSON Lines, without a model or a geometry processor.

    python examples/trace_by_hand.py > out/triangles.jsonl
    basrelief run out/triangles.jsonl --out out/triangles
"""
import json

WIDTH, HEIGHT = 64, 48
IDENTITY = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]
TOWARDS = [0, 0, 1]


def triangle(object_id, corners):
    """Returns a polygon command. Corners are window coordinates: x and y in pixels, depth from 0 to 1, and 1/w."""
    return {"polygon": {"object": object_id, "material": 0, "lod": 0, "bump": False, "arrival": 0, "position": corners}}


commands = [
    {"begin": {"format": "basrelief-display-list", "version": 1, "width": WIDTH, "height": HEIGHT, "generator": "by hand"}},
    {"material": {"id": 0, "name": "grey", "base_color": [0.5, 0.5, 0.5, 1], "normal_scale": 1,
                  "lighting": {"ka": 0.1, "kd": 0.8, "ks": 0.4, "n": 32}}},
    {"frame": {"index": 0, "camera": {"view_projection": IDENTITY, "to_light": TOWARDS, "to_viewer": TOWARDS},
               "lights": [{"directional": {"to_light": TOWARDS, "intensity": 1}}]}},
    {"object": {"id": 0, "name": "triangles", "centre": [0, 0, 0]}},
    triangle(0, [[4, 4, 0.5, 1], [60, 4, 0.5, 1], [4, 44, 0.5, 1]]),
    triangle(0, [[60, 8, 0.4, 1], [60, 44, 0.4, 1], [12, 44, 0.4, 1]]),
    {"frame_end": {}},
]
commands.append({"end": {"commands": len(commands)}})
for command in commands:
    print(json.dumps(command))
