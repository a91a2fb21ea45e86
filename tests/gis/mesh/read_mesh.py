"""Reads the text formats of meshes, from their specifications alone, and prints vertices (hexadecimal, exact) and faces (from 0).

Usage: read_mesh.py FILE.2dm|.dxf|.xml
"""
import sys
import xml.etree.ElementTree as ElementTree


def read_2dm(path):
    """SMS 2D mesh files: ND id x y z; E3T id n1 n2 n3 material."""
    nodes, faces = {}, []
    with open(path) as file:
        assert file.readline().strip() == "MESH2D"
        for line in file:
            words = line.split()
            if words[0] == "ND":
                nodes[int(words[1])] = tuple(float(word) for word in words[2:5])
            elif words[0] == "E3T":
                assert len(words) == 6
                faces.append([int(word) for word in words[2:5]])
    order = {number: place for place, number in enumerate(nodes)}
    return list(nodes.values()), [[order[n] for n in face] for face in faces]


def read_dxf(path):
    """DXF R12: pairs of lines, a group code and a value; 3DFACE has its corners in 10, 20, 30 to 13, 23, 33."""
    with open(path) as file:
        lines = [line.rstrip("\n") for line in file]
    pairs = [(int(code), value) for code, value in zip(lines[::2], lines[1::2])]
    assert pairs[-1] == (0, "EOF") and len(lines) % 2 == 0
    vertices, faces, face = [], [], None
    for code, value in pairs:
        if code == 0:
            if face:
                corners = [(face[10 + i], face[20 + i], face[30 + i]) for i in range(4)]
                assert corners[3] == corners[2]
                faces.append([len(vertices), len(vertices) + 1, len(vertices) + 2])
                vertices += corners[:3]
            face = {} if value == "3DFACE" else None
        elif face is not None and code >= 10:
            face[code] = float(value)
    return vertices, faces


def read_landxml(path):
    """LandXML 1.2: P is "northing easting elevation", F names three points."""
    space = "{http://www.landxml.org/schema/LandXML-1.2}"
    root = ElementTree.parse(path).getroot()
    assert root.tag == space + "LandXML" and root.get("version") == "1.2"
    assert root.find(f"{space}Units/{space}Metric").get("linearUnit") == "meter"
    definition = root.find(f"{space}Surfaces/{space}Surface/{space}Definition")
    assert definition.get("surfType") == "TIN"
    points = {}
    for point in definition.find(space + "Pnts"):
        north, east, up = (float(word) for word in point.text.split())
        points[point.get("id")] = (east, north, up)
    order = {name: place for place, name in enumerate(points)}
    return list(points.values()), [[order[n] for n in face.text.split()] for face in definition.find(space + "Faces")]


def main():
    path = sys.argv[1]
    readers = {".2dm": read_2dm, ".dxf": read_dxf, ".xml": read_landxml}
    vertices, faces = readers[path[path.rindex("."):]](path)
    for vertex in vertices:
        print("v", *(value.hex() for value in vertex))
    for face in faces:
        assert len(face) == 3
        print("f", *face)


if __name__ == "__main__":
    main()
