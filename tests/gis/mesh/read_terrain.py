#!/usr/bin/python3
"""Checks the deepest level of a set of terrain tiles by the text of the quantized-mesh-1.0 specification alone.

read_terrain.py FOLDER [POINTS BOUND]: POINTS is a text file of lines "longitude latitude height". Prints the largest error and exits 0
where every tile is well-formed, neighbours agree on their sides, and each point is covered and within BOUND.
"""
import json
import os
import struct
import sys

import numpy as np


def zigzag(codes):
    codes = codes.astype(np.int64)
    return np.cumsum((codes >> 1) ^ -(codes & 1))


def read(path):
    data = open(path, "rb").read()
    header = struct.unpack_from("<3d2f3dd3d", data, 0)
    at = 88
    (count,) = struct.unpack_from("<I", data, at)
    at += 4
    u, v, h = (zigzag(np.frombuffer(data, "<u2", count, at + 2 * count * k)) for k in range(3))
    at += 6 * count
    width, kind = (4, "<u4") if count > 65536 else (2, "<u2")
    at += -at % width
    (triangles,) = struct.unpack_from("<I", data, at)
    at += 4
    indices, highest = [], 0
    for code in np.frombuffer(data, kind, 3 * triangles, at):
        indices.append(highest - int(code))
        highest += code == 0
    at += 3 * triangles * width
    assert highest == count, "each vertex is used"
    sides = []
    for _ in range(4):
        (number,) = struct.unpack_from("<I", data, at)
        sides.append(np.frombuffer(data, kind, number, at + 4).astype(int))
        at += 4 + number * width
    assert at == len(data), "nothing follows"
    for values in (u, v, h):
        assert values.min() >= 0 and values.max() <= 32767
    for side, values, end in zip(sides, (u, v, u, v), (0, 0, 32767, 32767)):
        assert set(side) == set(np.flatnonzero(values == end)), "lists of sides"
    low, high = float(header[3]), float(header[4])
    height = low + h * ((high - low) / 32767)
    return {"header": header, "u": u, "v": v, "h": height, "t": np.array(indices).reshape(-1, 3), "sides": sides}


def check_header(tile, level, x, y):
    step = 180 / 2**level
    lon = np.radians(-180 + step * (x + tile["u"] / 32767))
    lat = np.radians(-90 + step * (y + tile["v"] / 32767))
    a, f = 6378137.0, 1 / 298.257223563
    n = a / np.sqrt(1 - f * (2 - f) * np.sin(lat) ** 2)
    places = np.stack([(n + tile["h"]) * np.cos(lat) * np.cos(lon), (n + tile["h"]) * np.cos(lat) * np.sin(lon), (n * (1 - f) ** 2 + tile["h"]) * np.sin(lat)])
    sphere = np.array(tile["header"][5:8])
    assert (np.linalg.norm(places - sphere[:, None], axis=0) <= tile["header"][8] * (1 + 1e-9) + 1e-3).all(), "bounding sphere"
    # A camera that sees a vertex must see the horizon point: tested straight above each vertex's horizon.
    scale = np.array([a, a, a * (1 - f)])
    point, scaled = np.array(tile["header"][9:12]), places / scale[:, None]
    if level > 4:
        direction = point / np.linalg.norm(point)
        length = np.maximum(np.linalg.norm(scaled, axis=0), 1)
        alpha = np.arccos(np.clip(direction @ scaled / np.linalg.norm(scaled, axis=0), -1, 1))
        assert (np.linalg.norm(point) >= (1 - 1e-12) / np.cos(alpha + np.arccos(1 / length))).all(), "horizon point"


def errors_at(tile, u, v, h):
    error = np.full(len(u), np.nan)
    for corners in tile["t"]:
        (au, bu, cu), (av, bv, cv), z = tile["u"][corners], tile["v"][corners], tile["h"][corners]
        area = (bu - au) * (cv - av) - (bv - av) * (cu - au)
        assert area > 0, "triangles face the sky"
        near = np.flatnonzero((u >= min(au, bu, cu) - 1e-6) & (u <= max(au, bu, cu) + 1e-6) & (v >= min(av, bv, cv) - 1e-6) & (v <= max(av, bv, cv) + 1e-6))
        p, q = u[near], v[near]
        wa, wb = ((bu - p) * (cv - q) - (bv - q) * (cu - p)) / area, ((cu - p) * (av - q) - (cv - q) * (au - p)) / area
        inside = np.minimum(np.minimum(wa, wb), 1 - wa - wb) >= -1e-9
        error[near[inside]] = np.abs(wa * z[0] + wb * z[1] + (1 - wa - wb) * z[2] - h[near])[inside]
    return error


folder = sys.argv[1]
layer = json.load(open(os.path.join(folder, "layer.json")))
assert layer["format"] == "quantized-mesh-1.0" and layer["scheme"] == "tms" and layer["projection"] == "EPSG:4326"
assert layer["maxzoom"] + 1 == len(layer["available"])
tiles = {}
for level, blocks in enumerate(layer["available"]):
    for b in blocks:
        for y in range(b["startY"], b["endY"] + 1):
            for x in range(b["startX"], b["endX"] + 1):
                tiles[level, x, y] = read(os.path.join(folder, str(level), str(x), f"{y}.terrain"))
assert (0, 0, 0) in tiles and (0, 1, 0) in tiles
for (level, x, y), tile in tiles.items():
    assert level == 0 or (level - 1, x // 2, y // 2) in tiles, "ancestors"
    check_header(tile, level, x, y)
    for other, side, facing, along in (((level, (x + 1) % 2 ** (level + 1), y), 2, 0, "v"), ((level, x, y + 1), 3, 1, "u")):
        if other in tiles:
            mine = sorted(zip(tile[along][tile["sides"][side]], tile["h"][tile["sides"][side]]))
            theirs = sorted(zip(tiles[other][along][tiles[other]["sides"][facing]], tiles[other]["h"][tiles[other]["sides"][facing]]))
            assert mine == theirs, f"tiles {level}/{x}/{y} and {other} differ on their common side"

worst = 0.0
if len(sys.argv) > 2:
    points, bound, deepest = np.loadtxt(sys.argv[2]), float(sys.argv[3]), layer["maxzoom"]
    across, down = (points[:, 0] + 180) / 180 * 2**deepest, (points[:, 1] + 90) / 180 * 2**deepest
    for place in set(zip(np.floor(across).astype(int), np.floor(down).astype(int))):
        here = (np.floor(across) == place[0]) & (np.floor(down) == place[1])
        error = errors_at(tiles[(deepest, *place)], (across[here] - place[0]) * 32767, (down[here] - place[1]) * 32767, points[here, 2])
        assert not np.isnan(error).any(), "a point lies in no triangle"
        worst = max(worst, error.max())
    assert worst <= bound, f"the largest error is {worst}"
print(len(tiles), worst)
