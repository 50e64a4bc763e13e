"""The project's random numbers: xoshiro256++ seeded by SplitMix64, normals by Box-Muller."""

import math

WORD = (1 << 64) - 1


class Generator:
    """Random numbers for one pair of seed and stream."""

    def __init__(self, seed, stream):
        x = (seed ^ (stream * 0x9E3779B97F4A7C15)) & WORD
        self.s = []
        for _ in range(4):
            x = (x + 0x9E3779B97F4A7C15) & WORD
            z = x
            z = ((z ^ (z >> 30)) * 0xBF58476D1CE4E5B9) & WORD
            z = ((z ^ (z >> 27)) * 0x94D049BB133111EB) & WORD
            self.s.append(z ^ (z >> 31))
        self.spare = None

    def word(self):
        def rotl(value, bits):
            return ((value << bits) | (value >> (64 - bits))) & WORD

        s = self.s
        result = (rotl((s[0] + s[3]) & WORD, 23) + s[0]) & WORD
        t = (s[1] << 17) & WORD
        s[2] ^= s[0]
        s[3] ^= s[1]
        s[1] ^= s[2]
        s[0] ^= s[3]
        s[2] ^= t
        s[3] = rotl(s[3], 45)
        return result

    def uniform(self):
        return (self.word() >> 11) * 2.0**-53

    def normal(self):
        if self.spare is not None:
            value, self.spare = self.spare, None
            return value
        u1, u2 = 1.0 - self.uniform(), self.uniform()
        r = math.sqrt(-2.0 * math.log(u1))
        self.spare = r * math.sin(2.0 * math.pi * u2)
        return r * math.cos(2.0 * math.pi * u2)
