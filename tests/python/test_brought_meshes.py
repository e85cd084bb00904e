"""Scans as people have them: each of these is a box, or a plate, of known volume and area."""

import json
import os
import struct

import doublet as d
import numpy as np
import pytest

SIZE = np.array([1.0, 1.8, 0.4])
CORNERS = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)]) * SIZE
QUADS = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
TRIANGLES = np.array([[quad[0], quad[k], quad[k + 1]] for quad in QUADS for k in (1, 2)])


def measured(mesh) -> tuple[int, int, float, float]:
    """Vertices, faces, volume, area."""
    v, f = np.asarray(mesh.vertices), np.asarray(mesh.faces)
    volume = np.einsum("ij,ij->i", v[f[:, 0]], np.cross(v[f[:, 1]], v[f[:, 2]])).sum() / 6
    return len(v), len(f), volume, np.linalg.norm(np.cross(v[f[:, 1]] - v[f[:, 0]], v[f[:, 2]] - v[f[:, 0]]), axis=1).sum() / 2


def require_box(path) -> None:
    vertices, faces, volume, area = measured(d.read_mesh(path))
    assert (vertices, faces) == (8, 12)
    assert volume == pytest.approx(0.72, abs=1e-6) and area == pytest.approx(5.84, abs=1e-5)


def stl(header=b"box", behind=b"", attribute=0, each=b"") -> bytes:
    data = header.ljust(80, b" ") + struct.pack("<I", len(TRIANGLES))
    for triangle in CORNERS[TRIANGLES]:
        data += struct.pack("<12f", 0, 0, 0, *triangle.ravel()) + struct.pack("<H", attribute) + each
    return data + behind


def stl_text(solid="solid box", end="\n") -> bytes:
    lines = [solid]
    for triangle in CORNERS[TRIANGLES]:
        lines += [" facet normal 0 0 0", "  outer loop"]
        lines += [f"\tvertex {x:.6f} {y:.6E} {z}" for x, y, z in triangle] + ["  endloop", " endfacet"]
    return end.join([*lines, "endsolid box", ""]).encode()


@pytest.mark.parametrize(
    "content",
    [
        stl(b"solid made by a program"),
        stl(behind=b"\0" * 92),
        stl(b"solid", behind=b"made by a program\n"),
        stl(b"SOLID", behind=b"\0"),
        stl(attribute=0x8000),
        stl(attribute=3, each=b"abc"),
        stl_text(),
        stl_text().upper(),
        stl_text("  Solid"),
        b"\xef\xbb\xbf" + stl_text(end="\r\n"),
        stl_text(end="\r"),
        stl_text().replace(b"\n  outer", b" outer"),
        stl_text(end="\r\n") + b"\x1a",
        stl_text() + b"\0" * 7,
    ],
    ids=[
        "solid in the header", "bytes behind", "solid and bytes", "SOLID and a byte", "colours", "attributes", "text",
        "capitals", "blanks before", "BOM and CRLF", "CR", "loop beside the normal", "end of DOS", "padded",
    ],
)  # fmt: skip
def test_stl(tmp_path, content):
    (tmp_path / "box.stl").write_bytes(content)
    require_box(tmp_path / "box.stl")


@pytest.mark.parametrize("counted", [0, 5])
def test_an_stl_that_was_not_counted_to_its_end_is_whole(tmp_path, counted):
    data = bytearray(stl())
    data[80:84] = struct.pack("<I", counted)
    (tmp_path / "box.stl").write_bytes(data)
    require_box(tmp_path / "box.stl")


@pytest.mark.parametrize("behind", [b"what a program says of itself, in just fifty bytes", b"\xff" * 100])
def test_other_bytes_behind_an_stl_are_no_triangles(tmp_path, behind):
    assert len(behind) % 50 == 0
    (tmp_path / "box.stl").write_bytes(stl() + behind)
    require_box(tmp_path / "box.stl")


@pytest.mark.parametrize("behind", [b"", b"\n", b"\0" * 7])
def test_ply_with_texture_behind_the_corners_of_each_face(tmp_path, behind):
    """As MeshLab writes them; and what programs leave behind the last face."""
    head = "ply\nformat binary_little_endian 1.0\nelement vertex 8\nproperty float x\nproperty float y\nproperty float z\n"
    head += f"element face {len(TRIANGLES)}\nproperty list uchar int vertex_indices\nproperty list uchar float texcoord\n"
    faces = [struct.pack("<B3iB6f", 3, *face, 6, *[0.5] * 6) for face in TRIANGLES]
    data = (head + "end_header\n").encode() + CORNERS.astype("<f4").tobytes() + b"".join(faces) + behind
    (tmp_path / "box.ply").write_bytes(data)
    require_box(tmp_path / "box.ply")


def test_a_truncated_stl_is_refused(tmp_path):
    (tmp_path / "box.stl").write_bytes(stl(b"solid")[:-1])
    with pytest.raises(d.Error, match="expected an STL file of 684 bytes for its 12 triangles, found 683 bytes"):
        d.read_mesh(tmp_path / "box.stl")


def obj(end="\n") -> str:
    lines = ["# a box # of six sides", *(f"v {x} {y} {z} # corner" for x, y, z in CORNERS)]
    for quad in QUADS:
        a, b, c, e = (f"{i + 1}//1" for i in quad)
        lines += [f"f {a} {b}\\", f"  {c} \\", f"{e} # side", ""]
    return end.join(lines)


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
def test_obj_with_comments_and_lines_that_go_on(tmp_path, end):
    (tmp_path / "box.obj").write_bytes(obj(end).encode())
    require_box(tmp_path / "box.obj")


def test_a_wrong_word_behind_a_line_that_goes_on_is_found_in_its_line(tmp_path):
    (tmp_path / "box.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 \\\n2 \\\nthree\n")
    with pytest.raises(d.Error, match=r"box\.obj:6: expected corners of a face, counted from 1, found 'three'|box\.obj:6: "):
        d.read_mesh(tmp_path / "box.obj")


STAR = list(zip(np.arange(10) * np.pi / 5, [2, 0.8] * 5))  # angle, radius
#: Plates by their outline, counterclockwise, and their area.
PLATES = {
    "an arrow": ([(0, 0), (2, 1), (0, 2), (1, 1)], 1.0),
    "an L": ([(0, 0), (3, 0), (3, 1), (1, 1), (1, 3), (0, 3)], 5.0),
    "an L from its inner corner": ([(1, 1), (1, 3), (0, 3), (0, 0), (3, 0), (3, 1)], 5.0),
    "a comb": ([(0, 0), (5, 0), (5, 3), (4, 3), (4, 1), (3, 1), (3, 3), (2, 3), (2, 1), (1, 1), (1, 3), (0, 3)], 11.0),
    "a star": ([(r * np.cos(a), r * np.sin(a)) for a, r in STAR], 10 * 0.8 * np.sin(np.pi / 5)),
}  # fmt: skip


@pytest.mark.parametrize("form", ["obj", "ply", "off"])
@pytest.mark.parametrize("plate", PLATES)
def test_polygons_that_are_not_convex_cover_what_they_enclose(tmp_path, plate, form):
    outline, area = PLATES[plate]
    turn = np.linalg.qr(np.array([[1.0, 2, 3], [0, 1, 4], [5, 6, 0]]))[0]
    points = np.c_[outline, np.zeros(len(outline))] @ turn.T
    rows, corners = [" ".join(map(repr, map(float, p))) for p in points], range(len(points))
    path = tmp_path / f"plate.{form}"
    if form == "obj":
        path.write_text("\n".join([*(f"v {row}" for row in rows), "f " + " ".join(str(i + 1) for i in corners)]) + "\n")
    elif form == "off":
        path.write_text("\n".join([f"OFF\n{len(rows)} 1 0", *rows, " ".join(map(str, [len(rows), *corners]))]) + "\n")
    else:
        head = f"ply\nformat ascii 1.0\nelement face 1\nproperty list uchar int vertex_indices\nelement vertex {len(rows)}\n"
        head += "property double x\nproperty double y\nproperty double z\nend_header\n"
        path.write_text("\n".join([head + " ".join(map(str, [len(rows), *corners])), *rows]) + "\n")
    mesh = d.read_mesh(path)
    vertices, faces, _, found = measured(mesh)
    assert (vertices, faces) == (len(outline), len(outline) - 2) and found == pytest.approx(area)
    normals = np.cross(*(mesh.vertices[mesh.faces[:, k]] - mesh.vertices[mesh.faces[:, 0]] for k in (1, 2)))
    assert (normals @ (turn @ [0, 0, np.linalg.det(turn)]) > 0).all()


@pytest.mark.parametrize("form", ["ply", "obj"])
def test_seams_are_closed(tmp_path, form):
    """Every side with corners of its own, as a texture needs them; a loose corner at a place of another stays."""
    corners = CORNERS[np.array(QUADS)].reshape(-1, 3)
    faces = [[4 * side, 4 * side + k, 4 * side + k + 1] for side in range(6) for k in (1, 2)]
    path = tmp_path / f"box.{form}"
    if form == "obj":
        lines = [*(f"v {x} {y} {z}" for x, y, z in corners), *(f"f {a + 1} {b + 1} {c + 1}" for a, b, c in faces)]
        path.write_text("\n".join(lines) + "\n")
    else:
        head = f"ply\nformat ascii 1.0\nelement vertex {len(corners)}\nproperty float x\nproperty float y\nproperty float z\n"
        head += f"element face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n"
        path.write_text(
            head + "\n".join([*(f"{x} {y} {z}" for x, y, z in corners), *(f"3 {a} {b} {c}" for a, b, c in faces)]) + "\n"
        )
    require_box(path)


def test_a_hole_stays_open_and_vertices_keep_their_numbers(tmp_path):
    mesh = d.Mesh(CORNERS, TRIANGLES[2:])
    d.write_mesh(tmp_path / "open.ply", mesh)
    read = d.read_mesh(tmp_path / "open.ply")
    np.testing.assert_array_equal(read.vertices, CORNERS)
    np.testing.assert_array_equal(read.faces, TRIANGLES[2:])


# --- .glb


def glb(path, change=lambda gltf: None):
    """A quarter of the box's size, in a node that makes the rest of it: scaled, turned and mirrored; and a camera."""
    points = (CORNERS / 4).astype("<f4").tobytes()
    indices = TRIANGLES.astype("<u2").tobytes()
    gltf = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [
            {"scale": [-2, 2, 2], "rotation": [0, np.sqrt(0.5), 0, np.sqrt(0.5)], "children": [1, 2]},
            {"mesh": 0, "matrix": [2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 5, 6, 7, 1]},
            {"camera": 0},
            {"mesh": 0, "name": "not in the scene"},
        ],
        "cameras": [{"type": "perspective", "perspective": {"yfov": 1, "znear": 0.1}}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}, {"attributes": {"POSITION": 0}, "mode": 1}]}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "type": "VEC3", "count": 8},
            {"bufferView": 1, "componentType": 5123, "type": "SCALAR", "count": 36},
        ],
        "bufferViews": [
            {"buffer": 0, "byteOffset": 0, "byteLength": len(points)},
            {"buffer": 0, "byteOffset": len(points), "byteLength": len(indices)},
        ],
        "buffers": [{"byteLength": len(points) + len(indices)}],
    }
    change(gltf)
    text = json.dumps(gltf).encode()
    text += b" " * (-len(text) % 4)
    binary = points + indices
    head = struct.pack("<4sIIII", b"glTF", 2, 28 + len(text) + len(binary), len(text), 0x4E4F534A)
    path.write_bytes(head + text + struct.pack("<II", len(binary), 0x004E4942) + binary)
    return path


def test_a_scan_in_glb_is_where_its_nodes_put_it(tmp_path):
    path = glb(tmp_path / "box.glb")
    require_box(path)
    vertices = d.read_mesh(path).vertices
    np.testing.assert_allclose(vertices[0], [14, 12, 10], atol=1e-6)  # (5, 6, 7), twice, mirrored in x, a quarter about y


def test_what_stands_behind_a_glb_is_left_aside(tmp_path):
    path = glb(tmp_path / "box.glb")
    whole = path.read_bytes()
    path.write_bytes(whole + bytes(7))
    require_box(path)
    for length in (0, 12, 19, 20, len(whole) - 40):  # as it says
        path.write_bytes(whole[:8] + struct.pack("<I", length) + whole[12:])
        with pytest.raises(d.Error, match=r"box\.glb: expected"):
            d.read_mesh(path)


def entry(*where, **more):
    def change(gltf):
        for key in where:
            gltf = gltf[key]
        gltf.update(more)

    return change


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        (entry("nodes", 1, children=[0]), "expected a tree of nodes"),
        (entry("nodes", 1, mesh=3), "expected one of 1 meshes, found number 3"),
        (entry("accessors", 0, count=80), "accessor 0 reaches beyond its buffer view"),
        (entry("accessors", 1, byteOffset=2), "accessor 1 reaches beyond its buffer view"),
        (entry("accessors", 1, bufferView=0, componentType=5126, count=24), "expected vertices from 0 to 8"),
        (entry("bufferViews", 0, byteLength=10**9), "reaches beyond its buffer view"),
        (entry(extensionsRequired=["KHR_draco_mesh_compression"]), "that need the extension KHR_draco_mesh_compression"),
        (entry("nodes", 1, skin=0), "expected a static scan"),
        (entry("buffers", 0, uri="secret.bin"), "expected a binary glTF 2.0 file without other files"),
        (entry("meshes", 0, weights=[1.0]), "expected a scan without morph targets in use"),
    ],
)
def test_wrong_glbs_get_their_sentence(tmp_path, change, sentence):
    with pytest.raises(d.Error, match=sentence) as error:
        d.read_mesh(glb(tmp_path / "box.glb", change))
    assert str(tmp_path / "box.glb") in str(error.value)


def test_nothing_is_written_as_glb(tmp_path):
    with pytest.raises(d.Error, match="expected a mesh file to write"):
        d.write_mesh(tmp_path / "box.glb", d.Mesh(CORNERS, TRIANGLES))


def test_a_pipe_is_no_file(tmp_path):
    os.mkfifo(tmp_path / "scan.ply")
    with pytest.raises(d.Error, match=r"scan\.ply: expected a file, found a device or pipe"):
        d.read_mesh(tmp_path / "scan.ply")
