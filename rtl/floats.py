"""Bits of floating-point numbers, as wires carry them."""

import struct


def single_of(bits):
    """Returns the number of single precision with these bits."""
    return struct.unpack(">f", bits.to_bytes(4, "big"))[0]


def single_bits(number):
    """Returns the bits of a number, rounded to single precision."""
    return int.from_bytes(struct.pack(">f", number), "big")


def rounded(number):
    """Rounds to single precision. Sums and products of two such numbers in double precision round as if at once."""
    return single_of(single_bits(number))


def double_of(bits):
    """Returns the number of double precision with these bits."""
    return struct.unpack(">d", bits.to_bytes(8, "big"))[0]


def double_bits(number):
    """Returns the bits of a number in double precision."""
    return int.from_bytes(struct.pack(">d", number), "big")
