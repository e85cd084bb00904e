"""What a glTF 2.0 viewer makes of a baked animation: nodes, skins and morph targets at a time, in NumPy."""

import json
from pathlib import Path

import numpy as np

WIDTH = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}
TYPE = {5120: np.int8, 5121: np.uint8, 5122: np.int16, 5123: np.uint16, 5125: np.uint32, 5126: np.float32}


class Viewer:
    def __init__(self, path: Path):
        data = path.read_bytes()
        length = int.from_bytes(data[12:16], "little")
        self.gltf, self.bytes = json.loads(data[20 : 20 + length]), data[28 + length :]
        self.node = {node["name"]: i for i, node in enumerate(self.gltf["nodes"])}
        self.channels = {
            (c["target"]["node"], c["target"]["path"]): animation["samplers"][c["sampler"]]
            for animation in self.gltf.get("animations", [])[:1]
            for c in animation["channels"]
        }

    def array(self, accessor: int) -> np.ndarray:
        at = self.gltf["accessors"][accessor]
        width = WIDTH[at["type"]]
        values = np.zeros((at["count"], width))
        if "bufferView" in at:
            values = self.numbers(at, at["componentType"], at["count"] * width).reshape(-1, width)
        if "sparse" in at:
            sparse = at["sparse"]
            rows = self.numbers(sparse["indices"], sparse["indices"]["componentType"], sparse["count"]).astype(int)
            values[rows] = self.numbers(sparse["values"], at["componentType"], sparse["count"] * width).reshape(-1, width)
        return values / np.iinfo(TYPE[at["componentType"]]).max if at.get("normalized") else values

    def numbers(self, at: dict, component: int, count: int) -> np.ndarray:
        first = self.gltf["bufferViews"][at["bufferView"]].get("byteOffset", 0) + at.get("byteOffset", 0)
        return np.frombuffer(self.bytes, TYPE[component], count, first).astype(float)

    def image(self) -> bytes:
        view = self.gltf["bufferViews"][self.gltf["images"][0]["bufferView"]]
        first = view.get("byteOffset", 0)
        return self.bytes[first : first + view["byteLength"]]

    def value(self, node: int, path: str, time: float, default):
        """Linear; rotations are normalised, which is near enough to a slerp between frames of 1/40 s."""
        if (node, path) not in self.channels:
            return np.asarray(default, float)
        sampler = self.channels[node, path]
        times, values = self.array(sampler["input"])[:, 0], self.array(sampler["output"])
        values = values.reshape(len(times), -1)
        found = np.array([np.interp(time, times, column) for column in values.T])
        return found / np.linalg.norm(found) if path == "rotation" else found

    def joints(self, time: float) -> dict[int, np.ndarray]:
        """(4, 4) world transform of every node."""
        world = {}

        def visit(node: int, parent: np.ndarray) -> None:
            at, local = self.gltf["nodes"][node], np.eye(4)
            x, y, z, w = self.value(node, "rotation", time, at.get("rotation", [0, 0, 0, 1]))
            local[:3, :3] = [
                [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
            ]
            local[:3, 3] = self.value(node, "translation", time, at.get("translation", [0, 0, 0]))
            world[node] = parent @ local
            for child in at.get("children", []):
                visit(child, world[node])

        for root in self.gltf["scenes"][0]["nodes"]:
            visit(root, np.eye(4))
        return world

    def mesh(self, name: str, time: float) -> np.ndarray:
        """(V, 3) m: morphed, then skinned."""
        vertices, blends = self.morphed(name, "POSITION", time), self.blends(name, time)
        return np.einsum("vij,vj->vi", blends[:, :3, :3], vertices) + blends[:, :3, 3]

    def normals(self, name: str, time: float) -> np.ndarray:
        """(V, 3) unit."""
        turned = np.einsum("vij,vj->vi", self.blends(name, time)[:, :3, :3], self.morphed(name, "NORMAL", time))
        return turned / np.linalg.norm(turned, axis=1, keepdims=True)

    def morphed(self, name: str, attribute: str, time: float) -> np.ndarray:
        node = self.node[name]
        primitive = self.gltf["meshes"][self.gltf["nodes"][node]["mesh"]]["primitives"][0]
        values, targets = self.array(primitive["attributes"][attribute]), primitive.get("targets", [])
        for weight, target in zip(self.value(node, "weights", time, np.zeros(len(targets))), targets):
            if weight:
                values = values + weight * self.array(target[attribute])
        return values

    def blends(self, name: str, time: float) -> np.ndarray:
        """(V, 4, 4) of the skin."""
        at = self.gltf["nodes"][self.node[name]]
        attributes = self.gltf["meshes"][at["mesh"]]["primitives"][0]["attributes"]
        skin, world = self.gltf["skins"][at["skin"]], self.joints(time)
        inverse_bind = self.array(skin["inverseBindMatrices"]).reshape(-1, 4, 4).transpose(0, 2, 1)
        matrices = np.array([world[joint] @ bind for joint, bind in zip(skin["joints"], inverse_bind)])
        weights, joints = (self.array(attributes[name]) for name in ("WEIGHTS_0", "JOINTS_0"))
        return np.einsum("vk,vkij->vij", weights, matrices[joints.astype(int)])
