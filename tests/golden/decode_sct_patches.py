"""The patch coder of trees, written from core/codec/patch-format.md alone; the numbers are those of its sections."""
import itertools
from collections import defaultdict

import numpy as np

from decode_sct import F32, STRETCH, Bytes, Decoder, clip, hold, make, new_model, require

# 2: numbers and atoms

def bin_of(a, most):
    e = a.bit_length() - 1
    return min(most, 2 * e + (a >> (e - 1) & 1) if a > 1 else a)

def signed(n):
    return -(n + 1) // 2 if n % 2 else n // 2

def mixer(k):
    return [65536 // k + 8192] * k

class Numbers:
    """Numbers in contexts."""
    def __init__(self):
        self.models, self.mixers, self.second = defaultdict(new_model), {}, defaultdict(new_model)
    def decode(self, decoder, *contexts):
        length = 0
        while length < 27 and decoder.mixed([self.models[i, k, length] for i, k in enumerate(contexts)], self.mixers.setdefault(length, mixer(len(contexts)))):
            length += 1
        n = min(length, 1)
        for i in range(length - 1):
            n = 2 * n + (decoder.bit() if i else decoder.coded(self.second[length]))
        return n

def decode_atoms(stream, count, m):
    inside = [(x, y) for y in range(m) for x in range(m) if (2 * x + 1 - m) ** 2 + (2 * y + 1 - m) ** 2 < m * m]
    decoder, numbers, atoms = Decoder(stream, 255), Numbers(), []
    for _ in range(count):
        shift = sum(decoder.bit() << i for i in (3, 2, 1, 0))
        v, most = make(int, m + 1, m + 2), (1 << (15 - shift)) - 1  # a border above, to the left and to the right: the index -1 is the last
        for x, y in inside:
            W, N, NW, NE = v[y][x - 1], v[y - 1][x], v[y - 1][x - 1], v[y - 1][x + 1]
            slope, size = bin_of(abs(W - NW) + abs(N - NW) + abs(N - NE), 33), bin_of(abs(W) + abs(N), 33)
            v[y][x] = clip((3 * (W + N) - 2 * NW + 2 >> 2) + signed(numbers.decode(decoder, slope, 4 * size + min(slope // 4, 3))), -most, most)
        atoms.append([[sample << shift for sample in row[:m]] for row in v[:m]])
    return np.array(atoms, np.int64).reshape(count, m, m)

# 4, 5: means and terms

def fit_moments(A, a, m):
    """How atoms fit slopes and curvatures: a row for each atom."""
    dy, dx = np.mgrid[1 - m:m:2, 1 - m:m:2]
    weights = 6 * m * dx, 6 * m * dy, 2 * (3 * dx**2 - m * m + 1), 2 * (3 * dy**2 - m * m + 1), 3 * dx * dy
    moments = np.array([[int((atom * a * weight).sum()) for weight in weights] for atom in A], np.int64).reshape(-1, 5)
    shift = max(0, int(np.abs(moments).max(initial=0)).bit_length() - 14)
    return np.sign(moments) * (np.abs(moments) >> shift)

def decode_means(decoder, wide, high):
    z, r, numbers, limit = make(int, high, wide), make(int, high + 1, wide + 2), Numbers(), 2**25 - 1
    for j in range(high):
        for i in range(wide):
            W = z[j][i - 1] if i else z[j - 1][0] if j else 0
            N, NW, NE = (z[j - 1][i], z[j - 1][max(0, i - 1)], z[j - 1][min(wide - 1, i + 1)]) if j else (W, W, W)
            around = r[j][i - 1], r[j - 1][i], r[j - 1][i - 1], r[j - 1][i + 1]
            predicted = clip(W + N - NW + (176 * (around[0] + around[1]) + 121 * around[2] + 128 >> 8), -limit, limit)
            r[j][i] = signed(numbers.decode(decoder, bin_of(abs(W - NW) + abs(N - NW) + abs(N - NE), 55), bin_of(sum(map(abs, around)), 55)))
            z[j][i] = clip(predicted + r[j][i], -limit, limit)
    return z

def decode_discs(stream, wide, high, s, moments):
    """Means, and for each disc the coefficients by atom."""
    decoder, terms, models, numbers, signs = Decoder(stream, 255), {}, defaultdict(new_model), Numbers(), mixer(2)
    z, mixers = decode_means(decoder, wide, high), defaultdict(lambda: mixer(5))
    for j, i in itertools.product(range(high), range(wide)):
        beside = [terms[place] for place in ((j, i - 1), (j - 1, i - 1), (j - 1, i), (j - 1, i + 1)) if place in terms]
        used, mine, k = sum(map(len, beside)), terms.setdefault((j, i), {}), min(s, len(moments))
        around = min(8, 8 * used // (s * len(beside))) if beside else 8
        while k > 0 and decoder.coded(models['F', min(s - k, 7), around]):
            k -= 1
        (NW, N, NE), (W, C, E), (SW, S, SE) = [[z[clip(j + v, 0, high - 1)][clip(i + u, 0, wide - 1)] for u in (-1, 0, 1)] for v in (-1, 0, 1)]
        e = (moments @ np.array([E - W, S - N, E + W - 2 * C, S + N - 2 * C, SE + NW - NE - SW])).tolist()
        order = sorted(range(len(e)), key=lambda atom: -abs(e[atom])) if k else []
        for t, atom in enumerate(order):
            fit, left, rest = abs(e[atom]), k - len(mine), len(e) - t
            ratio = min(15, 16 * fit // abs(e[order[0]])) if e[order[0]] else 0
            using = [other[atom] for other in beside if atom in other]
            if left == 0:
                break
            if left < rest:
                row, most = t if t < 64 else 64 + min(31, (t - 64) // 32), min(left, 8)
                asked = ('A1', row, most), ('A2', ratio, most), ('A3', len(using), ratio // 2), ('A4', atom, min(left, 4))
                if not decoder.mixed([models[key] for key in asked], mixers[most], STRETCH[clip(65536 * left // rest, 16, 65520) >> 4]):
                    continue
            down, balance = int(e[atom] < 0), sum((c > 0) - (c < 0) for c in using)
            negative = decoder.mixed([models['G1', ratio], models['G2', (balance > 0) - (balance < 0), down]], signs) != down
            mean = sum(abs(c) for other in beside for c in other.values()) // used if used else 0
            magnitude = 1 + min(2**25 - 2, numbers.decode(decoder, bin_of(fit // 64, 55), bin_of(mean, 55), atom))
            mine[atom] = -magnitude if negative else magnitude
    return z, terms

# 1, 3, 6: parameters, discs, elevations

def decode(tree):
    """The values of each level, from 0 on, as f32."""
    parameters = Bytes(tree.parameters)
    R, s, N, base, q, c, place = [parameters.number(form) for form in 'BBHfffB']
    require(place == 0)  # dictionary files are another format
    m = 2 * R
    A, (dy, dx) = decode_atoms(parameters.rest(), N, m), np.mgrid[1 - m:m:2, 1 - m:m:2]
    a = np.maximum(0, m * m - dx**2 - dy**2) ** 3 * 65536 // m**6
    moments, columns, rows = fit_moments(A, a, m), (tree.width - 1) // R + 2, (tree.height - 1) // R + 2
    S, T, weight = np.zeros((3, (rows + 1) * R, (columns + 1) * R), np.int64)
    streams = {node: stream for node, stream in tree.streams.items() if node[0] == 1} or {(1, 0, 0): tree.root}
    home = lambda count, cells: [min(k * R, cells - 1) // tree.side if tree.levels else 0 for k in range(count)]
    for (_, Y, X), stream in streams.items():
        ys, xs = [[k for k, node in enumerate(nodes) if node == mine] for nodes, mine in ((home(rows, tree.height), Y), (home(columns, tree.width), X))]
        z, terms = decode_discs(tree.parts(stream)[2], len(xs), len(ys), s, moments) if tree.parts(stream)[2] else (make(int, len(ys), len(xs)), {})
        for v, u in itertools.product(range(len(ys)), range(len(xs))):
            square = slice(ys[v] * R, ys[v] * R + m), slice(xs[u] * R, xs[u] * R + m)
            weight[square] += a
            S[square] += z[v][u] * a
            T[square] += sum((c * A[atom] for atom, c in terms.get((v, u), {}).items()), 0 * a)
    S, T, weight = (cells[R:R + tree.height, R:R + tree.width].astype(float) for cells in (S, T, weight))
    f = hold(base + (S * q + T * (2 * c)) / weight, F32).astype(F32)
    return [f[::1 << level, ::1 << level] for level in range(tree.levels + 1)]
