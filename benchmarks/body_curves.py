"""Compactness, generalisation and specificity of the body model (Davies, Twining & Taylor 2008), as a picture and a table.

python benchmarks/body_curves.py POPULATION.npz [--picture docs/pictures/body_model.png]
"""

import argparse
import tempfile
from pathlib import Path

import matplotlib
import numpy as np
from body_study import LEFT_OUT
from body_subjects import Population
from doublet import _doublet as d

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

SAMPLES = 200


def rest_shapes(people: Population) -> np.ndarray:
    """(M, V, 3) m, every mesh in the rest pose of its person, root joint at the origin."""
    shapes = []
    for mesh, person in enumerate(people.individual):
        world = people.transforms(mesh)
        unposed = d.dual_quaternion_skinning(people.vertices(mesh), people.weights, np.linalg.inv(world))
        unposed += people.vertices(mesh) - d.dual_quaternion_skinning(unposed, people.weights, world)
        shapes.append(unposed - people.arrays["ind_rest_joints"][person, 0])
    return np.array(shapes)


def trained(people: Population, individuals: list[int]) -> tuple[np.ndarray, np.ndarray]:
    """Mean (3V) and components (K, 3V) of the rest shape, m."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "model.npz"
        d.train_body_model(people.path, file, d.TrainOptions(individuals=individuals))
        with np.load(file) as model:
            components = model["component_scale"][:, None, None] * model["components_q"]
            return model["mean"].ravel().astype(float), components.reshape(len(components), -1)


def mean_distance(a: np.ndarray, b: np.ndarray) -> float:
    return 1000 * float(np.linalg.norm((a - b).reshape(-1, 3), axis=1).mean())


def curves(people: Population) -> dict[str, tuple[list[int], list[float]]]:
    left_out = np.sort(np.random.default_rng(1).permutation(people.people)[:LEFT_OUT])
    kept = [i for i in range(people.people) if i not in left_out]
    shapes = rest_shapes(people)
    mean, components = trained(people, kept)
    variance = (components**2).sum(axis=1)
    directions = components / np.sqrt(variance)[:, None]
    own = shapes[np.isin(people.individual, kept)].reshape(-1, len(mean))
    others = shapes[np.isin(people.individual, left_out)].reshape(-1, len(mean))
    rng = np.random.default_rng(2)
    counts = sorted({*range(1, 11), *range(15, len(components) + 1, 5), len(components)})
    found = {"compactness": [], "generalisation": [], "specificity": []}
    for count in counts:
        found["compactness"].append(float(variance[:count].sum() / variance.sum()))
        part = directions[:count]
        errors = [mean_distance(mean + (other - mean) @ part.T @ part, other) for other in others]
        found["generalisation"].append(float(np.mean(errors)))
        samples = mean + rng.standard_normal((SAMPLES, count)) @ components[:count]
        nearest = [own[np.argmin(((own - sample) ** 2).sum(axis=1))] for sample in samples]
        found["specificity"].append(float(np.mean([mean_distance(s, n) for s, n in zip(samples, nearest)])))
    return {name: (counts, values) for name, values in found.items()}


def draw(found: dict[str, tuple[list[int], list[float]]], path: Path) -> None:
    labels = {
        "compactness": "share of the variance",
        "generalisation": "error on people left out, mm",
        "specificity": "random bodies to nearest trained, mm",
    }
    figure, axes = plt.subplots(1, 3, figsize=(12, 3.2), layout="constrained")
    for axis, (name, (counts, values)) in zip(axes, found.items()):
        axis.plot(counts, values, color="#1f4e79")
        axis.set(title=name, xlabel="shape components", ylabel=labels[name], ylim=(0, None))
        axis.grid(alpha=0.3)
    figure.savefig(path, dpi=110)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("population", type=Path)
    parser.add_argument("--picture", type=Path)
    arguments = parser.parse_args()
    found = curves(Population(arguments.population))
    print("components", *found, sep="\t")
    counts = found["compactness"][0]
    for row, count in enumerate(counts):
        print(count, *(f"{values[row]:.3f}" for _, values in found.values()), sep="\t")
    if arguments.picture:
        draw(found, arguments.picture)


if __name__ == "__main__":
    main()
