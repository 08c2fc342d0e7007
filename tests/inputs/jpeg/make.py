#!/usr/bin/env python3
"""Writes matrix.z: small JPEG files of all kinds, and the pixels that libjpeg decodes from them.

Needs cjpeg and djpeg (Debian: libjpeg-turbo-progs). The file is a zlib stream of records:
  P width:u16 height:u16 pixels              RGB, 8 bits each
  J length:u8 name length:u32 file index:u16 index: number of the P record with the expected pixels
Numbers are little-endian.
"""
import math
import os
import struct
import subprocess
import tempfile
import zlib

WIDTH, HEIGHT = 44, 36
ORDINARY = ["1x1", "2x1", "1x2", "2x2", "4x1", "1x4", "4x2", "2x4", "3x1", "1x3", "3x2", "2x3", "3x3", "4x4", "4x3"]
UNUSUAL = [
    "1x1,2x2,2x2", "1x1,2x1,2x1", "1x1,1x2,1x2", "2x2,1x1,2x1", "2x2,2x1,1x1", "2x2,1x2,1x2", "2x1,1x2,1x2", "2x2,2x2,1x1",
    "1x1,2x1,1x2", "4x2,2x1,1x2", "4x1,2x1,2x1", "2x1,1x1,2x1", "2x2,2x1,2x1", "2x2,2x2,2x2", "1x2,1x1,1x1", "4x1,1x1,2x1",
    "4x4,2x2,1x1",
]
BASELINE = {
    "interleaved": None, "three-scans": "0; 1; 2;", "luma-chroma": "0; 1 2;", "two-and-one": "0 1; 2;", "reversed": "2; 1; 0;",
}
PROGRESSIVE = {
    "progressive": None,
    "progressive-three-scans": "0: 0-0,0,0; 1: 0-0,0,0; 2: 0-0,0,0; 0: 1-63,0,0; 1: 1-63,0,0; 2: 1-63,0,0;",
    "progressive-successive": "0 1 2: 0-0,0,1; 0: 1-5,0,2; 2: 1-63,0,1; 1: 1-63,0,1; 0: 6-63,0,2; 0: 1-63,2,1; 0 1 2: 0-0,1,0; "
                              "2: 1-63,1,0; 1: 1-63,1,0; 0: 1-63,1,0;",
    "progressive-two-dc": "0: 0-0,0,1; 1 2: 0-0,0,1; 0: 1-63,0,0; 1: 1-63,0,0; 2: 1-63,0,0; 0: 0-0,1,0; 1 2: 0-0,1,0;",
}


def source():
    """A smooth picture with two rectangles, as PPM."""
    pixels = bytearray()
    for y in range(HEIGHT):
        for x in range(WIDTH):
            rgb = [128 + 100 * math.sin(x / 9 + y / 23), 128 + 90 * math.cos(y / 11 - x / 31), 128 + 80 * math.sin((x + y) / 17)]
            if 10 <= y < 22 and 14 <= x < 26:
                rgb = [200, 40, 60]
            if 24 <= y < 33 and 28 <= x < 40:
                rgb = [20, 180, 220]
            pixels += bytes(max(0, min(255, round(c))) for c in rgb)
    return b"P6 %d %d 255\n" % (WIDTH, HEIGHT) + pixels


def cjpeg(arguments, script, ppm):
    with tempfile.NamedTemporaryFile("w", suffix=".txt") as file:
        if script:
            file.write(script)
            file.flush()
            arguments = [*arguments, "-scans", file.name]
        return encode(arguments, ppm)


def encode(arguments, ppm):
    result = subprocess.run(["cjpeg", "-quality", "80", *arguments], input=ppm, capture_output=True, check=False)
    return result.stdout if result.returncode == 0 else None


def djpeg(jpeg):
    ppm = subprocess.run(["djpeg", "-rgb"], input=jpeg, capture_output=True, check=True).stdout
    return ppm.split(b"255\n", 1)[1]


def variants():
    """Names, arguments of cjpeg, and scan scripts."""
    for sampling in ORDINARY + UNUSUAL:
        for scans, script in {**BASELINE, **PROGRESSIVE}.items():
            for restart in [None, "1B", "3B", "1"]:
                arguments = ["-sample", sampling] + (["-progressive"] if scans.startswith("progressive") else [])
                arguments += ["-restart", restart] if restart else []
                yield f"{sampling} {scans} restart {restart}", arguments, script
    for kind in [[], ["-progressive"], ["-restart", "2B"]]:
        for sampling in ["1x1", "2x2"]:
            yield " ".join(["grey", sampling, *kind]), ["-grayscale", "-sample", sampling, *kind], None
        yield " ".join(["rgb", *kind]), ["-rgb", *kind], None


def main():
    ppm, pictures, records = source(), {}, bytearray()
    for name, arguments, script in variants():
        jpeg = cjpeg(arguments, script, ppm)
        if jpeg is None:
            continue
        pixels = djpeg(jpeg)
        if pixels not in pictures:
            pictures[pixels] = len(pictures)
            records += b"P" + struct.pack("<HH", WIDTH, HEIGHT) + pixels
        records += b"J" + struct.pack("<B", len(name)) + name.encode() + struct.pack("<I", len(jpeg)) + jpeg
        records += struct.pack("<H", pictures[pixels])
    path = os.path.join(os.path.dirname(os.path.abspath(__file__)), "matrix.z")
    with open(path, "wb") as file:
        file.write(zlib.compress(bytes(records), 9))


main()
