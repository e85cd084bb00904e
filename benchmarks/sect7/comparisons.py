"""Materials against each other: recovery of a known one, Table 1, rivals of an estimate, two motions, fewer iterations."""

from pathlib import Path

import doublet as d
import numpy as np
from doublet.common.console import Console
from doublet.evaluation import metrics as evaluate
from doublet.evaluation import study
from doublet.export.animate import exact_motion
from filmed import Filming, filmed
from reconstructions import (
    NAMES,
    SEARCH,
    box_centre,
    energies,
    energy_job,
    estimate,
    markdown,
    nudged,
    plain_job,
    random_materials,
    recorded_options,
    rms_cm,
    run,
    simulate,
    stiff_centre,
    table_1,
)


def recovery(out: Path, session, truth: d.Material, how: Filming, search: dict, seconds: float, work: Path, workers: int):
    """Sect. 7, "Validation": the material of an artificial data set, estimated from its images. The paper: (5.4, 5.6, 0.75, 1.0,
    0.47) for (4.0, 4.9, 0.7, 1.0, 0.5), 0.6 cm RMS between the cloth of both. Poses and first surface are known here."""
    folder, options = filmed(out, session, truth, how, work)
    fps = plain_job(out, session)["fps"]
    search = {f"fit.{name}": value for name, value in search.items()}
    job = study.fit_jobs([folder], options=[{**options, **search}], fps=fps, threads=workers)[0]
    fit = run(study.fit, [{**job, "checkpoints": str(work.resolve())}], work, 1)[0]

    rows = recovered_parameters(fit["regions"], truth)
    header = ["region", "parameter", "true", "estimated", "abs. error, of the box", "90 % interval, of the box", "told"]
    print(markdown(header, rows), "\n")

    made, found = study.film_of(job), [d.Material(**region["parameters"]) for region in fit["regions"]]
    true = simulate(made, [truth] * len(found))[: round(seconds * fps)]
    others = {"truth, d_n moved by 0.001 of the box": nudged(truth), "centre of the box": box_centre(), **table_1()}
    samples = {"truth": [truth] * len(found), "estimate": found, **{n: [m] * len(found) for n, m in others.items()}}
    costs = run(energies, [energy_job(study.plain_job(folder, options, fps, 1), list(samples.values()))], work, 1)[0]
    rows = []
    for (name, sample), cost in zip(samples.items(), costs):
        rows.append([name, sum(cost), rms_cm(simulate(made, sample)[: len(true)], true, made)])
    print(markdown(["material", "E_fit, px^2", f"cloth to the truth's, RMS cm over {len(true) / fps:.3g} s"], rows))
    return fit, rows


def recovered_parameters(regions: list[dict], truth: d.Material) -> list[list]:
    unit, rows = d.ParameterSpace().unit, []
    for k, region in enumerate(regions):
        apart = np.abs(unit(d.Material(**region["parameters"])) - unit(truth))
        for name, error in zip(NAMES, apart):
            known = "{:.2f} to {:.2f}".format(*region["interval"][name])
            told = region["confidence"][name]
            rows.append([k, name, getattr(truth, name), region["parameters"][name], float(error), known, told])
    return rows


def table1(out: Path, session, how: Filming, work: Path, workers: int):
    """Table 1: whether E_fit tells the paper's six materials apart. Each is filmed on the character, and all six are compared
    with what was filmed. (1a and 1b are one skirt in two motions: the paper calls them the same material.)"""
    sets, jobs = table_1(), []
    base = plain_job(out, session)
    fps, regions = base["fps"], study.film_of(base).results.dressed.segmentation.region_count
    for truth in sets.values():
        folder, options = filmed(out, session, truth, how, work)
        jobs.append(energy_job(study.plain_job(folder, options, fps, 1), [[m] * regions for m in sets.values()]))
    costs = np.array(run(energies, jobs, work, workers)).sum(axis=2)  # (filmed, simulated)
    rows = []
    for k, (name, row) in enumerate(zip(sets, costs)):
        shown = [f"**{cost:.4g}**" if cost == row.min() else f"{cost:.4g}" for cost in row]
        rows.append([name, *shown, "yes" if row.argmin() == k else "no"])
    print(markdown(["filmed; E_fit, px^2, of", *sets, "own is lowest"], rows))
    own = int((costs.argmin(axis=1) == np.arange(len(sets))).sum())
    print(f"\nown material is the lowest of its row in {own} of {len(sets)}")
    return costs


def novel_surfaces(out: Path, motion_file: Path, fps: float, samples: dict, context: d.Context):
    """(name, (T, V, 3)) of every material on a new motion, and of skinning without any cloth."""
    character = d.Character.read(out / "character.glb")
    motion = exact_motion(character, motion_file, fps, context)
    animating = d.AnimateOptions(high=False, body=False, edge_collision=False)  # as animate_exactly()
    for name, materials in samples.items():
        character.materials = materials
        yield name, d.animate(character, motion, animating, context).surface
    yield "skinned, no cloth", [d.pose_surface(character.actor, dofs) for dofs in motion.dofs]


def estimates(out: Path, session, seeds: int, work: Path, workers: int) -> dict[str, list[d.Material]]:
    """What searches from other seeds than the first answer; they stop as that of OUT did."""
    jobs = study.fit_jobs([out], range(2, seeds + 1), [recorded_options(out, SEARCH)], plain_job(out, session)["fps"])
    fits = run(study.fit, [{**job, "checkpoints": str(work.resolve())} for job in jobs], work, workers)
    return {
        f"estimate, seed {job['seed']}": [d.Material(**region["parameters"]) for region in fit["regions"]]
        for job, fit in zip(jobs, fits)
    }


def rivals(out: Path, session, truth_folder: Path, every: int, seeds: int, count: int, work: Path, workers: int):
    """Sect. 7, user study: the estimate against other materials, by distance to the true garment instead of 52 people. As
    `doublet evaluate` measures it, on the reference motion and, if ground_truth/novel is there, on one that was not used.
    Beside Table 1 and the box's centre, at the estimate's damping: estimates from other seeds, and random materials."""
    made, truth = study.film_of(plain_job(out, session)), evaluate.Truth(truth_folder)
    recon, own, context = evaluate.Reconstruction(out), estimate(out), Console().context()
    others = {"centre of the box": box_centre(), "centre, k_stretch 1": stiff_centre(), **table_1()}
    others.update({f"random {k}": material for k, material in enumerate(random_materials(count, 0))})
    for material in others.values():
        material.k_damping = own[0].k_damping
    samples = {"estimate": own, **estimates(out, session, seeds, work, workers)}
    samples.update({name: [m] * len(own) for name, m in others.items()})
    found = {}
    surfaces = {name: simulate(made, materials) for name, materials in samples.items()}
    dressed = made.results.dressed.actor
    surfaces["skinned, no cloth"] = np.array([d.pose_surface(dressed, dofs) for dofs in recon.performance.dofs])
    for name, sequence in surfaces.items():
        found[name] = [evaluate.cloth_rms_cm(recon.animated(sequence), truth, every, context, name), ""]
    novel = truth.folder / "novel"
    if (novel / "motion.bvh").exists():
        there = evaluate.Truth(novel)
        faces = dressed.mesh.faces[np.asarray(dressed.face_valid, bool)]
        for name, moved in novel_surfaces(out, novel / "motion.bvh", made.fps, samples, context):
            moving = evaluate.Animated(dict(enumerate(moved)), faces)
            found[name][1] = evaluate.cloth_rms_cm(moving, there, every, context, name)
    shown = {name: row for name, row in found.items() if not name.startswith("random")}
    print(markdown(["material", "resim_cloth_cm", "novel_cloth_cm"], [[name, *row] for name, row in shown.items()]))
    for column, metric in enumerate(("resim_cloth_cm", "novel_cloth_cm")):
        if found["estimate"][column] != "":
            print(f"\n{metric}: {standing({name: row[column] for name, row in found.items()})}")
    return found


def standing(distances: dict[str, float]) -> str:
    """Of the estimates among the others, in words."""
    ours = [value for name, value in distances.items() if name.startswith("estimate")]
    table = [value for name, value in distances.items() if name.startswith("Table 1")]
    drawn = [value for name, value in distances.items() if name.startswith("random")]
    text = f"estimates {min(ours):.2f} to {max(ours):.2f}; nearest of Table 1 {min(table):.2f}, farthest {max(table):.2f}"
    if not drawn:
        return text
    nearer = sum(value < min(ours) for value in drawn)
    return f"{text}; nearest of {len(drawn)} random {min(drawn):.2f}; {nearer} of them nearer than every estimate"


def cross(outs: list[Path], sessions: list, truths: list, work: Path, workers: int):
    """Sect. 7, "Discussion": one garment in two motions, each estimate on each motion (rows: motions)."""
    own = [estimate(out) for out in outs]
    if len(own[0]) != len(own[1]):
        raise ValueError(f"{outs[0]} has {len(own[0])} cloth regions and {outs[1]} {len(own[1])}: expected one garment in both")
    centre = stiff_centre()
    centre.k_damping = own[0][0].k_damping
    samples = [*own, [centre] * len(own[0])]
    jobs = [energy_job(plain_job(out, session), samples) for out, session in zip(outs, sessions)]
    costs = np.array(run(energies, jobs, work, workers)).sum(axis=2)
    header = [f"of {outs[0].name}", f"of {outs[1].name}", "centre, k_stretch 1"]
    print(markdown(["E_fit, px^2, on", *header], [[out.name, *map(float, row)] for out, row in zip(outs, costs)]))
    if truths:
        rows, context = [], Console().context()
        for out, job, folder in zip(outs, jobs, truths):
            recon, truth = evaluate.Reconstruction(out), evaluate.Truth(folder)
            made = study.film_of(job)
            moving = [recon.animated(simulate(made, sample)) for sample in samples]
            rows.append([out.name, *(evaluate.cloth_rms_cm(m, truth, 1, context, "re-animation") for m in moving)])
        print("\n" + markdown(["resim_cloth_cm on", *header], rows))
    return costs


def fewer_iterations(sweeps: int, substeps: int) -> list[tuple[int, int]]:
    """25 % fewer, of the sweeps (rounded down and up) or of the substeps where that comes out even."""
    fewer = sorted({3 * sweeps // 4, -(-3 * sweeps // 4)})
    return [(n, substeps) for n in fewer if n > 0] + ([(sweeps, 3 * substeps // 4)] if substeps % 4 == 0 else [])


def iterations(out: Path, session):
    """Sect. 7, "Discussion": the same material with 25 % fewer iterations; the paper: 1.8 cm RMS over the cloth."""
    own, used = estimate(out), study.film_of(plain_job(out, session)).options["cloth"]
    rows = []
    for sweeps, substeps in dict.fromkeys([(24, 1), (used.iterations, used.substeps)]):
        full = apart_from(out, session, own, (sweeps, substeps))
        close = [nudged(m) for m in own]
        rows.append([f"{sweeps} x {substeps}", "the same, d_n moved by 0.001 of the box", 0, full((sweeps, substeps), close)])
        for fewer in fewer_iterations(sweeps, substeps):
            less = 100 * (1 - fewer[0] * fewer[1] / (sweeps * substeps))
            rows.append([f"{sweeps} x {substeps}", f"{fewer[0]} x {fewer[1]}", f"{less:.0f}", full(fewer, own)])
    print(markdown(["sweeps x substeps", "against", "% fewer", "cloth, RMS cm"], rows))
    return rows


def apart_from(out: Path, session, materials: list[d.Material], steps: tuple[int, int]):
    """RMS cm to `materials` under sweeps x substeps `steps`, as a function of other steps and materials."""

    def made_with(steps: tuple[int, int]) -> study.Film:
        return study.film_of(plain_job(out, session, cloth={"iterations": steps[0], "substeps": steps[1]}))

    reference = simulate(made_with(steps), materials)
    return lambda other, others: rms_cm(simulate(made_with(other), others), reference, made_with(other))
