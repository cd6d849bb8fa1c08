"""The checksum of recorded messages."""

import struct


def xxh64(content, seed):
    """XXH64 from its specification, version 0.1.1."""
    primes = (0, 11400714785074694791, 14029467366897019727, 1609587929392839161, 9650029242287828579, 2870177450012600261)
    full = 2**64 - 1

    def rotated(value, bits):
        return (value << bits | value >> 64 - bits) & full

    def round_(lane, word):
        return rotated((lane + word * primes[2]) & full, 31) * primes[1] & full

    rest = content
    if len(content) < 32:
        value = seed + primes[5]
    else:
        lanes = [seed + primes[1] + primes[2], seed + primes[2], seed, seed - primes[1]]
        while len(rest) >= 32:
            lanes = [round_(lane & full, word) for lane, word in zip(lanes, struct.unpack("<4Q", rest[:32]))]
            rest = rest[32:]
        value = sum(rotated(lane, bits) for lane, bits in zip(lanes, (1, 7, 12, 18)))
        for lane in lanes:
            value = ((value & full ^ round_(0, lane)) * primes[1] + primes[4]) & full
    value = (value + len(content)) & full
    for size, step in ((8, lambda v, w: rotated(v ^ round_(0, w), 27) * primes[1] + primes[4]),
                       (4, lambda v, w: rotated(v ^ w * primes[1] & full, 23) * primes[2] + primes[3]),
                       (1, lambda v, w: rotated(v ^ w * primes[5] & full, 11) * primes[1])):
        while len(rest) >= size:
            value = step(value, int.from_bytes(rest[:size], "little")) & full
            rest = rest[size:]
    for bits, prime in ((33, primes[2]), (29, primes[3]), (32, 1)):
        value = (value ^ value >> bits) * prime & full
    return value
