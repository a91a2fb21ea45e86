"""The predictive coder of trees, written from core/codec/predictive-format.md alone; the numbers are those of its sections."""
import copy
import itertools
import os
import zlib

import numpy as np

import decode_sct
from decode_sct import CODEC, Bytes, Decoder, clip, make, new_model

ORIGINS = {1: (1, 1), 2: (1, 0), 3: (0, 1)}  # x, y of the phases in a square of 2 x 2 cells
PAIRS = {
    1: '1 1   1 -1   3 1   3 -1   1 3   1 -3   3 3   3 -3   5 1   5 -1   1 5   1 -5',
    2: '1 0   0 1    2 1   2 -1   1 2   1 -2   3 0   0 3    3 2   3 -2   2 3   2 -3',
    3: '1 0   0 1    1 1   1 -1   2 1   2 -1   1 2   1 -2   3 0   0 3    3 1   3 -1   1 3   1 -3'}
PAIRS = {phase: list(zip(*[iter(map(int, text.split()))] * 2)) for phase, text in PAIRS.items()}
BEFORE = {  # taps, activity, noise
    1: ([1476, 1275, -201, -196, -222, -173, -27, -3, 26, 34, 48, 11], [26, 13, 8, 3, 0, 4, 4, 8, 0], 32),
    2: ([2011, 729, -242, -282, -124, -97, -123, 32, 72, 97, -3, -22], [24, 6, 3, 2, 4, 11, 5, 4, 1], 32),
    3: ([1961, 587, 218, 87, -351, -341, -140, -91, -203, -37, 120, 143, 53, 42], [17, 6, 1, 2, 3, 9, 14, 2, 3], 32)}
MARGIN = 8  # of the lattice, in its own cells

# 1, 2: values and parameters

class Map:
    def __init__(self, parameters, type):
        self.kind, b = parameters.number('B'), parameters.varint()
        self.base = -(b - 1) // 2 - 1 if b % 2 else b // 2
        self.low = parameters.number('B') if self.kind == 3 else 0
        self.quantum = [parameters.number('d') for _ in range(2)] if self.kind in (1, 4) else None
        self.type, self.beside = type, self.low > 0 or self.kind == 4
    def values(self, n, c):
        if self.kind == 3:
            bits = [((self.base + int(one) << self.low) + low) % 2**64 for one, low in zip(n.flat, c.flat)]
            return np.array([k if k < 2**63 else 3 * 2**63 - k - 1 for k in bits], np.uint64).view(float).reshape(n.shape)
        k = n + self.base
        if self.kind in (1, 4):
            values = k.astype(float) * self.quantum[0] / self.quantum[1]
            return values if self.kind == 1 else self.moved(values, c)
        k = np.clip(k, -2**31, 2**31 - 1)
        return np.where(k >= 0, k, 2**31 - k - 1).astype(np.uint32).view(np.float32).astype(float)

    def moved(self, values, c):
        """The floats that lie c above some, held to the finite ones."""
        width, real, whole = (32, np.float32, np.uint32) if self.type == 6 else (64, np.float64, np.uint64)
        other = lambda bits: bits if bits < 2**(width - 1) else 2**(width - 1) - 1 - bits  # k of a float's bits
        place = lambda value: other(int(np.array(value, real).view(whole)))
        highest = np.finfo(real).max
        ks = [clip((place(value) + int(one) + 2**63) % 2**64 - 2**63, place(-highest), place(highest)) for value, one in zip(values.flat, c.flat)]
        return np.array([k if k >= 0 else 2**(width - 1) - 1 - k for k in ks], whole).view(real).astype(float).reshape(values.shape)

def raw(decoder, count):
    n = 0
    for _ in range(count):
        n = 2 * n + decoder.bit()
    return n

def number(decoder, models):
    n = decoder.unary(models[:19])
    m = 2**n + raw(decoder, n) - 1
    return -m if m and decoder.bit() else m

class Parameters:
    def __init__(self, stream, levels):
        decoder, same = Decoder(stream, 1000), new_model()
        T, R, A, N = make(new_model, 4, 20)
        self.lowest, self.highest = [(raw(decoder, 32) ^ 1 << 31) - (1 << 31) for _ in range(2)]
        self.root_step, self.steps, self.phases, before = raw(decoder, 25), [None], [None], BEFORE
        for level in range(1, levels + 1):
            self.steps.append(self.steps[-1] if level > 1 and decoder.coded(same) else raw(decoder, 25))
            phases = {}
            for phase, (taps, activity, noise) in before.items():
                t = [before + 4 * number(decoder, T) for before in taps[1:]]
                r = [4 * number(decoder, R) for _ in range(4)]
                a = [before + number(decoder, A) for before in activity]
                phases[phase] = [2048 - sum(t)] + t, r, a, noise + number(decoder, N)
            self.phases.append(phases)
            before = {phase: (t, a, e) for phase, (t, r, a, e) in phases.items()}
    def hold(self, n):
        return clip(n, self.lowest, self.highest)

# 3: root

def decode_root(stream, tree, p, void):
    decoder, models, values = Decoder(stream, 1000), make(new_model, 34), make(int, *tree.sizes[-1])
    before = p.lowest + p.highest >> 1
    for y, x in itertools.product(*map(range, tree.sizes[-1])):
        guess = values[y][x - 1] + values[y - 1][x] >> 1 if x and y else values[y - 1][x] if y else before
        values[y][x] = guess
        if not void[y][x]:
            n = decoder.unary(models[:33])
            k = (1 << (n - 1)) + raw(decoder, n - 1) if n else 0
            values[y][x] = before = p.hold(guess + (-k if k and decoder.bit() else k) * p.root_step)
    return values

# 4: nodes

def fill_lattice(cells, void, inside, p):
    """Gives all cells of a lattice a value, those beyond the level (`inside` holds the rest: y0, y1, x0, x1) last."""
    y0, y1, x0, x1 = inside
    unknown = {(y, x) for y in range(y0, y1) for x in range(x0, x1) if void[y][x]}
    for y, x in unknown:
        cells[y][x] = p.hold(0)
    for _ in range(8):
        means = {}
        for y, x in unknown:
            known = [cells[v][u] for v in range(max(y0, y - 1), min(y1, y + 2)) for u in range(max(x0, x - 1), min(x1, x + 2)) if (v, u) not in unknown]
            if known:
                means[y, x] = sum(known) // len(known)
        for (y, x), mean in means.items():
            cells[y][x] = mean
        unknown -= means.keys()
    extend = lambda line, a, b: [p.hold(2 * line[a] - line[min(2 * a - i, b - 1)]) if i < a else p.hold(2 * line[b - 1] - line[max(2 * b - 2 - i, a)]) if i >= b else line[i]
                                 for i in range(len(line))]
    rows = [extend(row, x0, x1) if y0 <= y < y1 else row for y, row in enumerate(cells)]
    return [list(row) for row in zip(*[extend(column, y0, y1) for column in zip(*rows)])]

class Node:
    """Values v, R and m of a block by (x, y), cells of level l - 1 from its corner."""
    def __init__(self, lattice, size, void, step, p, stream):
        self.high, self.wide = size
        self.v = {(2 * (x - MARGIN), 2 * (y - MARGIN)): value for y, row in enumerate(lattice) for x, value in enumerate(row)}
        self.R, self.m, self.void, self.step, self.p = {}, {}, void, step, p
        self.decoder, self.states = Decoder(stream, 400) if stream else None, copy.deepcopy(STATES) if stream else None
    def decode_phase(self, phase, taps, recursion, activity, noise):
        (ox, oy), W, H, v, p, F = ORIGINS[phase], (self.wide + 1) // 2, (self.high + 1) // 2, self.v, self.p, {}
        margin = {1: 4, 2: 2, 3: 0}[phase]
        places = [(2 * X + ox, 2 * Y + oy) for Y in range(-margin, H + margin) for X in range(-margin, W + margin)]
        for x, y in places:
            total = sum(t * (v[x + dx, y + dy] + v[x - dx, y - dy]) for t, (dx, dy) in zip(taps, PAIRS[phase]))
            F[x, y] = clip(total + 128 >> 8, 16 * p.lowest, 16 * p.highest)
        for x, y in places:
            v[x, y] = F[x, y] + 8 >> 4
        for x, y in places:
            if 0 <= x < self.wide and 0 <= y < self.high and not self.void[y][x]:
                R = lambda dx, dy: self.R.get((x + dx, y + dy), 0)
                G = F[x, y] + (recursion[0] * R(-2, 0) + recursion[1] * R(0, -2) + recursion[2] * R(-2, -2) + recursion[3] * R(2, -2) + 128 >> 8)
                guess = p.hold(G + 8 >> 4)
                k = self.residual(phase, x, y, F[x, y], G, guess, activity, noise) if self.decoder else 0
                v[x, y] = p.hold(guess + k * self.step)
                self.R[x, y], self.m[x, y] = 16 * v[x, y] - F[x, y], min(abs(k) * self.step, 1 << 20)

    # 5: residuals

    def expected(self, phase, x, y, F, activity, noise):
        """E, f3 and f4."""
        v = lambda dx, dy: self.v[x + dx, y + dy]
        m = lambda *places: sum(self.m.get((x + dx, y + dy), 0) for dx, dy in places)
        near = ((-1, -1), (1, -1), (-1, 1), (1, 1)) if phase == 1 else ((-1, 0), (1, 0), (0, -1), (0, 1))
        a, b, c, d = [v(*place) for place in near]
        s = a + b + c + d
        f = [m((-2, 0)), m((0, -2)), m((-2, -2), (2, -2)), sum(abs(4 * z - s) for z in (a, b, c, d)) >> 2, abs(s - (F >> 2))]
        bend = lambda *steps: sum(abs(4 * v(*z) - sum(v(z[0] + dx, z[1] + dy) for dx, dy in steps)) for z in near) >> 2
        if phase == 1:
            f += [m((0, -4), (4, -2)), abs(a + d - b - c), bend((-2, 0), (2, 0), (0, -2), (0, 2)), bend((-2, -2), (2, -2), (-2, 2), (2, 2))]
        elif phase == 2:
            f += [m((0, -1), (0, 1)), m((-2, -1), (2, -1), (-2, 1), (2, 1)), m((0, -3), (0, 3)),
                  abs(2 * a - v(-3, 0) - b) + abs(2 * b - a - v(3, 0)) + abs(2 * c - v(0, -3) - d) + abs(2 * d - c - v(0, 3))]
        else:
            f += [m((-1, 0), (1, 0)), m((-1, -1), (1, -1), (-1, 1), (1, 1)), m((-1, -2), (1, -2), (-1, 2), (1, 2), (-3, 0), (3, 0)),
                  m((-1, -3), (1, -3), (-1, 3), (1, 3), (-3, -1), (3, -1), (-3, 1), (3, 1))]
        f = [min(one, 1 << 20) for one in f]
        return ((4 + noise % 4 << noise // 4) >> 2) + sum(weight * one for weight, one in zip(activity, f)), f[3], f[4]

    def residual(self, phase, x, y, F, G, guess, activity, noise):
        decoder, states, step = self.decoder, self.states, self.step
        E, f3, f4 = self.expected(phase, x, y, F, activity, noise)
        m, R, g = lambda dx, dy: self.m.get((x + dx, y + dy), 0), lambda dx, dy: self.R.get((x + dx, y + dy), 0), q(step)
        u = q(E) - 32 - g
        shift = clip(u - 3 >> 2, 0, 24)
        scale = clip(u - 4 * shift + 25, 0, 31)
        half, offset = scale // 2, clip(G - 16 * guess, -8, 7)
        lean = (offset // step if offset >= 0 else -(-offset // step)) + 8
        n = lambda size: sum(times * E < 512 * size for times in (1, 3, 6))
        beside = 4 * n(m(-2, 0)) + n(m(0, -2))
        relief = 16 * clip((q(16 * f3 + 1) - 16 - g >> 1) + 4, 0, 15) + clip((q(16 * f4 + 1) - 16 - g >> 1) + 6, 0, 15)
        rows, columns = {1: (range(-2, 0), range(-2, 3)), 2: (range(-2, 2), range(-2, 3)), 3: (range(-2, 3), range(-2, 2))}[phase]
        X, Y = x // 2, y // 2
        A = sum(self.m.get((2 * (X + i) + 1, 2 * (Y + j) + 1), 0) for j in rows for i in columns) * (2 if phase == 1 else 1)
        wide = clip(q(4 * A + 1) - g - 6 >> 1, 0, 23)
        d = lambda r: 2 if r > 4 * step else 0 if r < -4 * step else 1
        turn = 3 * d(R(-2, 0)) + d(R(0, -2))

        def more(z):
            if z > 2:
                return decoder.coded(states['beyond'][min(z - 3, 3)][scale])
            models = (states['scale'][z][32 * abs(lean - 8) + scale], states['beside'][z][16 * half + beside], states['relief'][z][relief],
                      states['wide'][z][16 * wide + half])
            return decoder.mixed(models, states['decision'][z][phase - 1][scale // 4], rate=6)
        z = next((z for z in range(20) if not more(z)), 20)
        if z == 20:
            n = next((n for n in range(32) if not decoder.bit()), 32)
            z = 20 + 2**n + raw(decoder, n) - 1
        whole = z
        for i in range(shift):
            model = states['low'][4 * min(whole, 7) + scale % 4] if i == 0 else states['next'][min(z, 15)] if i == 1 else None
            z = 2 * z + (decoder.coded(model) if model else decoder.bit())
        if z and decoder.mixed((states['lean'][8 * lean + scale // 4], states['turn'][9 * (phase - 1) + turn]), states['sign'], rate=6):
            return -z
        return z

def q(v):
    o = v.bit_length() - 1
    return 4 * o + (4 * v >> o) - 4

# 6: first states

def first_states():
    with open(os.path.join(CODEC, 'predict_states.inc')) as file:
        numbers = map(int, file.read().replace(',', ' ').split())
    shapes = dict(scale=(3, 288), beside=(3, 256), relief=(3, 256), wide=(3, 384), beyond=(4, 32), low=(32,), next=(16,), lean=(128,), turn=(27,))
    states = {name: make(lambda: decode_sct.unpack_state(next(numbers)), *shape) for name, shape in shapes.items()}
    return states | dict(decision=make(lambda: [next(numbers) for _ in range(4)], 3, 3, 8), sign=[next(numbers), next(numbers)])

STATES = first_states()

def split(stream, beside):
    """The stream of the numbers and the second part."""
    parts = Bytes(stream)
    return (parts.blob(), parts.rest()) if beside and stream else (stream, b'')

def fill_beside(stream, values_of, cells, root):
    """Sets the cells of an array that the second part of a stream has; the lattice of a node is there already."""
    places = [(y, x) for y, x in np.ndindex(cells.shape) if root or y % 2 or x % 2]
    if stream and values_of.kind == 3:
        bits = np.unpackbits(np.frombuffer(zlib.decompress(stream), np.uint8), bitorder='little').tolist()
        for i, place in enumerate(places):
            cells[place] = sum(bit << k for k, bit in enumerate(bits[i * values_of.low:(i + 1) * values_of.low]))
    if stream and values_of.kind == 4:
        decoder, exact, sign, length, digits = Decoder(stream, 255), make(new_model, 4, 5, 5), new_model(), make(new_model, 64), make(new_model, 65, 32)
        density = lambda near: [0, 1, 2, 3, 3, 4][min(5, np.count_nonzero(near))]
        for y, x in places:
            row, column = cells[y, max(0, x - 6):x + 7], cells[max(0, y - 6):y + 7, x]
            if not decoder.coded(exact[2 * (y % 2) + x % 2][density(row)][density(column)]):
                negative, n, m = decoder.coded(sign), 1 + decoder.unary(length[1:]), 1
                for _ in range(n - 1):
                    m = 2 * m + (decoder.coded(digits[n][m]) if m < 32 else decoder.bit())
                cells[y, x] = -m if negative else m

def decode(tree):
    """The stored values of each level, from 0 on."""
    parameters = Bytes(tree.parameters)
    values_of, p = Map(parameters, tree.type), Parameters(parameters.rest(), tree.levels)
    voids = lambda level: decode_sct.decode_voids(tree, level) if tree.voids else np.zeros(tree.sizes[level], np.uint8)
    void, levels = voids(tree.levels), []
    numbers, bits = split(tree.parts(tree.root)[2], values_of.beside)
    cells, beside = np.array(decode_root(numbers, tree, p, void.tolist()), np.int64), np.zeros(tree.sizes[-1], np.int64)
    fill_beside(bits, values_of, beside, True)
    for level in range(tree.levels, 0, -1):
        levels.insert(0, values_of.values(cells, beside))
        fine_beside = np.zeros(tree.sizes[level - 1], np.int64)
        fine_beside[::2, ::2] = beside
        beside_blocks = tree.squares(fine_beside, level, tree.side)
        fine, fine_void = np.zeros(tree.sizes[level - 1], np.int64), voids(level - 1)
        high, wide = tree.sizes[level]
        blocks, masks = tree.squares(fine, level, tree.side), tree.squares(fine_void, level, tree.side)
        for node, block in blocks.items():
            top, left = [index * tree.side // 2 - MARGIN for index in node[1:]]
            H, W = [(count + 1) // 2 + 2 * MARGIN for count in block.shape]
            y0, y1, x0, x1 = max(0, top), min(high, top + H), max(0, left), min(wide, left + W)
            place = slice(y0 - top, y1 - top), slice(x0 - left, x1 - left)
            lattice, lattice_void = np.zeros((H, W), np.int64), np.zeros((H, W), np.int64)
            lattice[place], lattice_void[place] = cells[y0:y1, x0:x1], void[y0:y1, x0:x1]
            filled = fill_lattice(lattice.tolist(), lattice_void.tolist(), (y0 - top, y1 - top, x0 - left, x1 - left), p)
            numbers, bits = split(tree.parts(tree.streams[node])[2], values_of.beside)
            fill_beside(bits, values_of, beside_blocks[node], False)
            decoded = Node(filled, block.shape, masks[node].tolist(), p.steps[level], p, numbers)
            for phase, kept in p.phases[level].items():
                decoded.decode_phase(phase, *kept)
            block[:] = [[decoded.v[x, y] for x in range(block.shape[1])] for y in range(block.shape[0])]
        cells, void, beside = fine, fine_void, fine_beside
    return [values_of.values(cells, beside)] + levels
