"""A decoder of trees of elevations (.sct), written from core/codec/tree-format.md alone; the numbers are those of its sections.

    tree = Tree(open('dem.sct', 'rb').read());  levels = list(stored_values(tree))  # f64 arrays from level 0 on, NaN where void
"""
import copy
import importlib
import itertools
import math
import os
import struct
import zlib

import numpy as np

F32 = np.float32
CODEC = os.path.join(os.path.dirname(os.path.abspath(__file__)), '..', '..', 'core', 'codec')
TYPES = dict(enumerate((np.uint8, np.int16, np.uint16, np.int32, np.uint32, np.float32, np.float64), 1))

# 1 to 3: file, directory, levels and nodes

def require(condition):
    if not condition:
        raise ValueError('the file is damaged')

class Bytes:
    """Numbers and blobs, one after the other."""
    def __init__(self, data):
        self.data, self.at = data, 0
    def take(self, count):
        require(self.at + count <= len(self.data))
        self.at += count
        return self.data[self.at - count:self.at]
    def number(self, form):
        return struct.unpack('<' + form, self.take(struct.calcsize(form)))[0]
    def varint(self):
        byte = self.number('B')
        return byte if byte < 128 else byte - 128 + 128 * self.varint()
    def blob(self):
        return self.take(self.varint())
    def left(self):
        return len(self.data) - self.at
    def rest(self):
        return self.take(self.left())

class Tree:
    def __init__(self, data):
        require(len(data) >= 16 and data[:4] == b'\x89SCT' and data[-4:] == b'\x01SCT')
        length, crc = struct.unpack('<II', data[-12:-4])
        require(length <= len(data) - 16)
        d = Bytes(data[len(data) - 12 - length:-12])
        require(zlib.crc32(d.data) == crc)
        self.coder, self.type, self.width, self.height = d.number('B'), d.number('B'), d.varint(), d.varint()
        self.side, flags = 1 << d.number('B'), d.number('B')
        self.point, self.voids = flags >> 3 & 1, flags >> 4 & 1
        t0, t3, t1, t5 = [d.number('d') for _ in range(4)] if flags & 1 else [0] * 4
        t2, t4 = [d.number('d') for _ in range(2)] if flags & 2 else (0, 0)
        self.transform = (t0, t1, t2, t3, t4, t5) if flags & 1 else None
        self.nodata = d.number('d') if flags & 4 else None
        self.scale, self.offset = (d.number('d'), d.number('d')) if flags & 32 else (1, 0)
        self.unit, self.metres = (d.blob().decode(), d.number('d')) if flags & 64 else ('m', 1)
        texts = b'\0\0'
        if flags & 128:
            texts = zlib.decompress(d.blob()) if d.number('B') else d.blob()
        self.crs, self.band, *items = [text.decode() for text in texts[:-1].split(b'\0')]
        self.items = dict(zip(items[::2], items[1::2]))
        self.claim = d.number('B')
        self.claimed = d.number('d') if self.claim > 1 else 0
        self.parameters, self.root = d.blob(), d.blob()
        self.flat = self.coder == 1 and len(self.parameters) > 7  # section 6.7
        self.sizes, self.streams, at = [(self.height, self.width)], {}, 4  # rows, columns of each level
        while max(self.sizes[-1]) > 8:
            self.sizes.append(tuple((n + 1) // 2 for n in self.sizes[-1]))
        self.levels = len(self.sizes) - 1
        for node in [node for level in range(self.levels, 0, -1) for node in self.nodes(level)]:
            count = d.varint()
            stream = self.streams[node] = data[at:at + count]
            at += count
            require(count == 0 or d.number('I') == zlib.crc32(stream))
        require(at == len(data) - 12 - length and d.at == len(d.data))
    def nodes(self, level):
        """Addresses of the nodes of a level: level, row, column."""
        high, wide = [-(-n // self.side) for n in self.sizes[level - 1]]
        return [(level, j, i) for j in range(high) for i in range(wide)]
    def parts(self, stream):
        """Mask of voids, flat water and the coder's stream."""
        parts = Bytes(stream)
        return *(parts.blob() if there and parts.left() else b'' for there in (self.voids, self.flat)), parts.rest()
    def squares(self, band, level, side):
        """The part of an array over a level that each node has, side x side from the corner."""
        return {(l, j, i): band[j * side:(j + 1) * side, i * side:(i + 1) * side] for l, j, i in self.nodes(level)}

# 4: bits

def make_squash():
    table, a = [0] * 5633, 1 << 32
    for t in range(2817):
        table[2816 + t] = min(65520, ((a >> 8) << 16) // ((a >> 8) + (1 << 24)))
        table[2816 - t] = 65536 - table[2816 + t]
        a += 16809946 * a >> 32
    return table

SQUASH = make_squash()
STRETCH = [next((k for k in range(5633) if SQUASH[k] >= p + 8), 5632) - 2816 for p in range(0, 65536, 16)]

def squash(t):
    return SQUASH[clip(t, -2816, 2816) + 2816]

def clip(v, low, high):
    return max(low, min(high, v))

def make(leaf, *shape):
    return [make(leaf, *shape[1:]) for _ in range(shape[0])] if shape else leaf()

def new_model():
    return [1 << 21, 0]

class Decoder:
    def __init__(self, data, limit):
        self.data, self.at, self.limit, self.low, self.high, self.code = data, 0, limit, 0, 2**64 - 1, 0
        self.shift(), self.shift()
    def shift(self):
        self.code = (self.code << 32) % 2**64 + int.from_bytes(self.data[self.at:self.at + 4].ljust(4, b'\0'), 'big')
        self.at += 4
    def bit(self, p=32768):
        middle = self.low + (self.high - self.low >> 16) * p
        bit = int(self.code <= middle)
        self.low, self.high = (self.low, middle) if bit else (middle + 1, self.high)
        while self.low >> 32 == self.high >> 32 or self.high - self.low < 1 << 24:
            if self.low >> 32 != self.high >> 32:
                self.high = self.low | 2**32 - 1
            self.low, self.high = (self.low << 32) % 2**64, (self.high << 32) % 2**64 + 2**32 - 1
            self.shift()
        return bit
    def update(self, model, bit):
        model[0] += ((4194303 if bit else 0) - model[0]) * (131072 // (2 * model[1] + 3)) >> 16
        model[1] += model[1] < self.limit
        return bit
    def coded(self, model):
        return self.update(model, self.bit(clip(model[0] >> 6, 16, 65520)))
    def mixed(self, models, weights, *more, rate=20):
        """A bit by models and maybe more logits."""
        logits = [STRETCH[model[0] >> 10] for model in models] + list(more)
        p = squash(sum(weight * logit for weight, logit in zip(weights, logits)) >> 16)
        bit = self.bit(p)
        for i, logit in enumerate(logits):
            weights[i] += ((bit << 16) - p) * logit * rate + (1 << 19) >> 20
        for model in models:
            self.update(model, bit)
        return bit
    def unary(self, models):
        """How many bits are 1 before one is 0, each by the next model."""
        return next((n for n, model in enumerate(models) if not self.coded(model)), len(models))

# 5: voids

def decode_voids(tree, level):
    """1 where void."""
    return decode_mask(tree, level, tree.parts(tree.root)[0], {node: tree.parts(stream)[0] for node, stream in tree.streams.items()})

def decode_mask(tree, level, root, streams):
    if level == tree.levels:
        high, wide = tree.sizes[level]
        require(len(root) == (high * wide + 7) // 8)
        return np.unpackbits(np.frombuffer(root, np.uint8), bitorder='little')[:high * wide].reshape(high, wide)
    coarse = np.pad(decode_mask(tree, level + 1, root, streams), (0, 1), mode='edge')
    mask = np.zeros(tree.sizes[level], np.uint8)
    for node, block in tree.squares(mask, level + 1, tree.side).items():
        if streams[node]:
            block[:] = decode_block_mask(streams[node], block.shape, coarse[node[1] * tree.side // 2:, node[2] * tree.side // 2:])
    return mask

def decode_block_mask(stream, shape, coarse):
    decoder, cells, coarse = Decoder(stream, 250), make(int, *shape), coarse.tolist()
    models = [[make(lambda: list(first), 8) for first in [(1 << 15, 8), *[(1 << 21, 0)] * 14, (127 << 15, 8)]] for _ in range(4)]
    for y in range(shape[0]):
        for x in range(shape[1]):
            X, Y, u, v = x // 2, y // 2, x & 1, y & 1
            here = coarse[Y][X]
            around = here + 2 * coarse[Y][X + u] + 4 * coarse[Y + v][X] + 8 * coarse[Y + v][X + u]
            left, above = cells[y][x - 1] if x else here, cells[y - 1][x] if y else here
            beside = left + 2 * above + 4 * (cells[y - 1][x - 1] if x and y else here)
            cells[y][x] = decoder.coded(models[u + 2 * v][around][beside]) if u or v else here
    return cells

# 6: wavelet coder

ENERGY = ((56, 15, 48, 18, 18, 32, 0, 0, 0, 0, 6, 2), (51, 16, 47, 7, 15, 27, 12, 6, 0, 0, 6, 1), (36, 8, 33, 5, 16, 31, 10, 4, 10, 3, 3, 0))
MEAN = ((-63, 3, 8, 7, -3, -7), (22, 4, -63, 3, -4, -12), (-11, -1, -8, 0, 8, 14))
NEXT = ((0, 2), (5, 7), (1, 3), (6, 4), (2, 0), (4, 6), (3, 1), (7, 5))
LOW = (1.31949571, 1.82213203, 2.55308988, 3.60131921, 5.08967079, 7.1966855, 10.1772269, 14.3926227)
HIGH = (0.844662386, 1.07131195, 1.45700408, 2.02683743, 2.85303083, 4.02994697, 5.69748045, 8.05684325)
STEPS = ((0, 0.43797085, -0.10537847), (1, 0.86679982, -0.02212343), (0, -0.04921203, 0.02216245), (1, -1.57278217, 0.14314374))
BIN = [0, 1, 2, 3, 3, 4, 4, 4] + 5 * [5] + 12 * [6] + [7]

def norm(level, band):
    low, high = [math.prod([F32(1.41421356)] * (level - 8), start=F32(table[min(level, 8) - 1])) for table in (LOW, HIGH)]
    return (high * low, high * low, high * high, low * low)[band]

def unpack_state(a):
    return [64 * squash(24 * (a >> 5)), a & 31]

def first_states():
    with open(os.path.join(CODEC, 'subband_states.inc')) as file:
        numbers = map(int, file.read().replace(',', ' ').split())
    shapes = dict(energy=(10, 2, 3, 40), local=(10, 2, 8, 8, 2), exponent=(4, 28), mantissa=(28,), sign_mean=(3, 16), sign_pattern=(3, 27), flag=(3, 8, 4))
    states = {name: make(lambda: unpack_state(next(numbers)), *shape) for name, shape in shapes.items()}
    return states | {name: make(lambda: [next(numbers), next(numbers)], *shape) for name, shape in dict(decision=(10, 2, 8), sign=(3,)).items()}

class Block:
    """Coefficients of a band of a node, and their magnitudes, in a border of zeros: two to the left and above, three beyond."""
    def __init__(self, height, width):
        self.height, self.width, self.v, self.m = height, width, make(int, height + 5, width + 5), make(int, height + 5, width + 5)
    def place(self, x, y):
        """The magnitude at a place and the sum of those of its neighbours."""
        m, x, y = self.m, x + 2, y + 2
        return m[y][x], m[y][x - 1] + m[y][x + 1] + m[y - 1][x] + m[y + 1][x]

def decode_band(decoder, states, band, blocks, parent, u, v):
    block, flags, state = blocks[band], [], 0
    for y in range(block.height):
        if y % 8 == 0:
            above, flags = flags + [0], []
            for b in range(-(-block.width // 8)):
                c = sum(sum(row[u + 4 * b + 2:u + 4 * b + 6]) for row in parent.m[v + y // 2 + 2:v + y // 2 + 6]) if parent else 0
                beside = sum(flags[-1:]) + sum(above[b:b + 2])
                flags.append(decoder.coded(states['flag'][band][BIN[min(c, 25)]][beside]))
        for x in range(block.width):
            if flags[x // 8]:
                places = [other.place(x, y) for other in blocks[:band]]
                places = (places + [(0, 0)] * 2)[:2] + [parent.place(u + x // 2, v + y // 2) if parent else (0, 0)]
                state = decode_coefficient(decoder, states, band, block, x + 2, y + 2, places, state)

def decode_coefficient(decoder, states, band, block, x, y, places, state):
    around = lambda rows: (rows[y][x - 1], rows[y][x - 2], rows[y - 1][x], rows[y - 2][x], rows[y - 1][x - 1], rows[y - 1][x + 1])
    seen, q = around(block.m), state & 1
    e = sum(weight * m for weight, m in zip(ENERGY[band], seen + sum(places, ()))) >> 4
    octave = e.bit_length() - 1
    E = 0 if e < 2 else min(39, 4 * octave + (4 * e >> octave) - 6)
    near = BIN[min(25, 2 * seen[2] + seen[4] + seen[5] + 2 * seen[0] >> 1)]
    cross = BIN[min(25, sum(2 * h + a // 2 for h, a in places) // 2)]
    k = 0
    while k < 10 and decoder.mixed((states['energy'][k][q][band][E], states['local'][k][q][near][cross][band == 2]), states['decision'][k][q][min(7, E // 4)]):
        k += 1
    if k == 10:
        n, rest = decoder.unary(states['exponent'][E // 10][:25]), 1
        for i in range(n):
            rest = 2 * rest + (decoder.bit() if i else decoder.coded(states['mantissa'][n]))
        k += rest - 1
    if k:
        mean = sum(weight * clip(value, -255, 255) for weight, value in zip(MEAN[band], around(block.v)))
        w, _, n, _, nw, _ = ((value > 0) - (value < 0) + 1 for value in around(block.v))
        models = states['sign_mean'][band][clip(((mean >> 1) + 8 * (e + 8)) // (e + 8), 0, 15)], states['sign_pattern'][band][w + 3 * n + 9 * nw]
        negative = decoder.mixed(models, states['sign'][band])
        block.v[y][x] = -(2 * k - q) if negative else 2 * k - q
        block.m[y][x] = min(255, 2 * k - q)
    return NEXT[state][k & 1]

def decode_root(stream, size, step):
    decoder, models, value, values = Decoder(stream, 60), make(new_model, 39), 0, []
    for _ in range(size[0] * size[1]):
        n, f = decoder.unary(models), 0
        for i in range(n):
            f = 2 * f + decoder.bit() if i else 1
        value += -(f + 1) // 2 if f % 2 else f // 2
        values.append(F32(value) * step)
    return np.array(values, F32).reshape(size)

def lift(z):
    """Along the first axis."""
    if len(z) == 1:
        return lift(np.concatenate([z, 0 * z]))[:1]
    last = len(z) - 1
    mirrored = lambda i: z[last - np.abs(last - i % (2 * last))]
    for parity, a, b in STEPS:
        i = np.arange(parity, last + 1, 2)
        z[i] -= F32(a) * (mirrored(i - 1) + mirrored(i + 1)) + F32(b) * (mirrored(i - 3) + mirrored(i + 3))
    return z

def synthesise(low, bands, size):
    g, z = F32(1) / F32(0.90860742), np.zeros(size, F32)
    z[::2, ::2], z[::2, 1::2], z[1::2, ::2], z[1::2, 1::2] = low * g, bands[0] * g, bands[1], bands[2]
    z = lift(z)
    z[:, ::2] *= g
    return lift(z.T).T

def decode_wavelet(tree):
    """The values of each level, from 0 on, as f32."""
    step, *shrink = struct.unpack('<f3B', tree.parameters[:7])
    step, offsets = F32(step), np.array([0] + shrink, F32) / F32(256)
    levels = [decode_root(tree.parts(tree.root)[2], tree.sizes[-1], F32(2) * step / norm(max(1, tree.levels), 3))]
    first, half, parents = first_states(), tree.side // 2, {}
    for level in range(tree.levels, 0, -1):
        high, wide = tree.sizes[level - 1]
        bands = [np.zeros(shape, F32) for shape in (((high + 1) // 2, wide // 2), (high // 2, (wide + 1) // 2), (high // 2, wide // 2))]
        windows, nodes = [tree.squares(band, level, half) for band in bands], {}
        for node in tree.nodes(level):
            l, j, i = node
            blocks = nodes[node] = [Block(*window[node].shape) for window in windows]
            stream, states = tree.parts(tree.streams[node])[2], copy.deepcopy(first)
            decoder, parent = Decoder(stream, 160), parents.get((l + 1, j // 2, i // 2), (None,) * 3)
            for band in range(3 if stream else 0):
                decode_band(decoder, states, band, blocks, parent[band], i % 2 * half // 2, j % 2 * half // 2)
                v = np.array(blocks[band].v)[2:-3, 2:-3]
                magnitude = (np.abs(v).astype(F32) - offsets[np.minimum(np.abs(v), 3)]) * (step / norm(level, band))
                windows[band][node][:] = np.where(v == 0, F32(0), np.where(v < 0, -magnitude, magnitude))
        levels.insert(0, synthesise(levels[0], bands, (high, wide)))
        parents = nodes
    return levels

def decode_flat_water(tree, level, cells):
    """Puts the values of flat cells in their place."""
    water = {node: FlatWater(tree.parts(stream)[1], tree.type) for node, stream in tree.streams.items()}
    mask = decode_mask(tree, level, tree.parts(tree.root)[1], {node: flat.mask for node, flat in water.items()})
    blocks = tree.squares(cells, level + 1, tree.side)
    for node, flat in tree.squares(mask, level + 1, tree.side).items():
        if water[node].mask:
            water[node].decode(flat.tolist(), blocks[node])

class FlatWater:
    """Of a node."""
    def __init__(self, blob, kind):
        data = Bytes(blob)
        count = data.varint() if blob else 0
        self.values = [data.number('f' if kind == 6 else 'd') for _ in range(count)] if kind > 5 else [data.varint() for _ in range(count)]
        if kind < 6 and count:
            first, *others = self.values
            self.values = list(itertools.accumulate(others, lambda v, more: v + more + 1, initial=-(first + 1) // 2 if first % 2 else first // 2))
        self.mask, self.indexes = data.blob() if count > 1 else data.rest(), data.rest()
    def decode(self, flat, block):
        decoder, models, most, seen = Decoder(self.indexes, 250), [new_model(), new_model()], len(self.values) - 1, {}
        for y, x in itertools.product(range(len(flat)), range(len(flat[0]))):
            if flat[y][x]:
                k = next((k for k, place in enumerate(((y, x - 1), (y - 1, x))) if place in seen), None)
                if most and k is not None and decoder.coded(models[k]):
                    seen[y, x] = seen[((y, x - 1), (y - 1, x))[k]]
                else:
                    bits = [decoder.bit() for _ in range(most.bit_length())]
                    seen[y, x] = min(most, int(''.join(map(str, bits)) or '0', 2))
                block[y, x] = self.values[seen[y, x]]

# 7: values

def hold(values, kind):
    """To a type of stored values."""
    if np.dtype(kind).kind == 'f':
        return np.clip(values, np.finfo(kind).min, np.finfo(kind).max).astype(kind).astype(float)
    values = np.clip(values, np.iinfo(kind).min, np.iinfo(kind).max)
    return np.where(values < 0, -np.floor(0.5 - values), np.floor(values + 0.5)) + 0.0

def stored_values(tree):
    # The other coders have documents and modules of their own, which build on this one.
    decode = decode_wavelet if tree.coder == 1 else importlib.import_module({2: 'decode_sct_predictive', 3: 'decode_sct_patches'}[tree.coder]).decode
    for level, values in enumerate(decode(tree)):
        values = hold(values.astype(float), TYPES[tree.type])
        if tree.flat and level < tree.levels:
            decode_flat_water(tree, level, values)
        if tree.voids:
            values[decode_voids(tree, level) == 1] = np.nan
        yield values
