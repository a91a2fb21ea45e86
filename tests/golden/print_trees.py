#!/usr/bin/env python3
"""Prints trees as tests/golden/print_trees.cpp does, but as the independent decoder reads them.

    print_trees.py [--expect TEXT] FILE...    with TEXT, prints nothing but the first line that is not as in that file, and fails
"""
import argparse
import itertools
import os
import sys
import zlib

import numpy as np

import decode_sct


def number(value):
    return 'void' if np.isnan(value) else '%.17g' % value


def describe(tree, name):
    yield f'{name}: coder {tree.coder}, type {tree.type}, {tree.width} x {tree.height}, nodes of {tree.side}, voids {tree.voids}'
    yield f'  scale {number(tree.scale)}, offset {number(tree.offset)}, unit {tree.unit} of {number(tree.metres)} m, point {tree.point}'
    yield f'  transform {" ".join(map(number, tree.transform)) if tree.transform else "none"}'
    yield f'  nodata {"none" if tree.nodata is None else number(tree.nodata)}, claim {tree.claim} of {number(tree.claimed)}'
    yield f'  crs {tree.crs}, band {tree.band}'
    for key, value in sorted(tree.items.items()):
        yield f'  item {key} = {value}'
    for level, values in enumerate(decode_sct.stored_values(tree)):
        high, wide = values.shape
        values[np.isnan(values)] = np.nan
        cells = [number(values[y, x]) for x, y in ((0, 0), (wide // 2, high // 2), (wide - 1, high // 3), (wide - 1, high - 1))]
        yield f'  level {level}: {wide} x {high}, CRC {zlib.crc32(values.astype("<f8").tobytes()):08x}, {" ".join(cells)}'


parser = argparse.ArgumentParser()
parser.add_argument('--expect')
parser.add_argument('trees', nargs='+')
arguments = parser.parse_args()
np.seterr(all='ignore')
lines = []
for path in arguments.trees:
    with open(path, 'rb') as file:
        lines += describe(decode_sct.Tree(file.read()), os.path.basename(path))
if not arguments.expect:
    print('\n'.join(lines))
    sys.exit()
with open(arguments.expect, encoding='utf-8') as file:
    expected = file.read().split('\n')[:-1]
for wanted, found in itertools.zip_longest(expected, lines):
    if wanted != found:
        sys.exit(f'expected: {wanted}\nfound:    {found}')
