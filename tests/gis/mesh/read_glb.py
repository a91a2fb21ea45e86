#!/usr/bin/python3
"""Reads a GLB by the text of the glTF 2.0 specification alone, and writes its triangles, in glTF's axes, as nine doubles each."""
import json
import struct
import sys

import numpy as np

data = open(sys.argv[1], "rb").read()
magic, version, length = struct.unpack_from("<4sII", data, 0)
assert magic == b"glTF" and version == 2 and length == len(data)
json_length, json_type = struct.unpack_from("<I4s", data, 12)
assert json_type == b"JSON" and json_length % 4 == 0
document = json.loads(data[20 : 20 + json_length].decode("utf-8"))
bin_length, bin_type = struct.unpack_from("<I4s", data, 20 + json_length)
assert bin_type == b"BIN\0" and bin_length % 4 == 0 and 28 + json_length + bin_length == len(data)
binary = data[28 + json_length :]
assert document["buffers"][0]["byteLength"] <= bin_length and "uri" not in document["buffers"][0]


def values(index):
    accessor = document["accessors"][index]
    view = document["bufferViews"][accessor["bufferView"]]
    dtype = {5123: "<u2", 5125: "<u4", 5126: "<f4"}[accessor["componentType"]]
    width = {"SCALAR": 1, "VEC2": 2, "VEC3": 3}[accessor["type"]]
    start = view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
    assert start % np.dtype(dtype).itemsize == 0
    flat = np.frombuffer(binary, dtype, accessor["count"] * width, start)
    return flat.reshape(-1, width)


triangles = []


def visit(index, scale, translation):
    node = document["nodes"][index]
    assert "matrix" not in node and "rotation" not in node
    translation = translation + scale * np.array(node.get("translation", [0, 0, 0]), float)
    scale = scale * np.array(node.get("scale", [1, 1, 1]), float)
    if "mesh" in node:
        for primitive in document["meshes"][node["mesh"]]["primitives"]:
            assert primitive.get("mode", 4) == 4
            positions = values(primitive["attributes"]["POSITION"])
            accessor = document["accessors"][primitive["attributes"]["POSITION"]]
            assert positions.min(axis=0).tolist() == accessor["min"] and positions.max(axis=0).tolist() == accessor["max"]
            indices = values(primitive["indices"])[:, 0]
            assert indices.max() < len(positions) and indices.max() < 65535
            triangles.append((positions.astype(float) * scale + translation)[indices].reshape(-1, 9))
    for child in node.get("children", []):
        visit(child, scale, translation)


for root in document["scenes"][document["scene"]]["nodes"]:
    visit(root, np.ones(3), np.zeros(3))
np.concatenate(triangles).astype("<f8").tofile(sys.argv[2])
print(len(document["meshes"]))
