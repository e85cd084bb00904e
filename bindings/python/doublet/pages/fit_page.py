"""The material search as a page: energy and parameters over evaluations, and how well the video determines each parameter.

Rewritten while the search runs (fit_progress.html), and a section of report.html afterwards.
"""

from __future__ import annotations

import csv
import html
import io
import json
import time
from pathlib import Path

import numpy as np

from .. import _doublet as d
from ..common.files import write_text
from .html_document import page, table

UNITS = {"d_n": "1/m", "d_t": "1/s"}
NAMES = {
    "d_n": "drag along the normal",
    "d_t": "drag along the surface",
    "k_bend": "bending",
    "k_stretch": "stretching",
    "k_friction": "friction",
    "k_damping": "damping",
    "width": "width of the garment",
}
#: What is doubtful about a parameter, in short.
WARNINGS = {
    "lower_bound": "at the lower bound of its box",
    "upper_bound": "at the upper bound of its box",
    "guess": "a guess",
    "seeds": "depends on the seed",
}
SECONDS_BETWEEN = 10  # at least; and drawing takes a twentieth of the time at most


def sections(out: Path) -> str:
    """What material.json and fit_log.csv of OUT say. Raises RuntimeError if they are not what `doublet fit` writes: anybody may
    have written them."""
    try:
        return results(out)
    except (AttributeError, IndexError, KeyError, RecursionError, TypeError, ValueError) as error:
        files = f"{out / 'material.json'} and {out / 'fit_log.csv'}"
        raise RuntimeError(f"{files}: expected what the stage 'fit' writes, found {type(error).__name__}: {error}") from error


def results(out: Path) -> str:
    fitted = json.loads((out / "material.json").read_text(encoding="utf-8"))
    if not fitted["regions"]:
        return "<p>No cloth, so there was no material to estimate.</p>"
    with (out / "fit_log.csv").open(newline="", encoding="utf-8") as stream:
        log = list(csv.DictReader(stream))
    parts = [energy_plot(log)]
    if fitted.get("interrupted"):
        parts.append("<p>The search is not over: the best samples so far. The same command goes on with it.</p>")
    for k, region in enumerate(fitted["regions"]):
        parts.append(f"<h3>Region {k}</h3>{parameters(region)}<p>{html.escape(energies(region))}</p>")
        parts += [f"<p>{html.escape(line)}</p>" for line in describe_confidence(region)]
        parts += [f'<p class="doubt">Doubtful: {html.escape(line)}</p>' for line in sentences(region)]
        parts.append(parameter_plot([row for row in log if row["region"] == str(k)], fitted["estimated"]))
        if "draws" in region:
            parts.append(corner_plot(np.array(region["draws"]), region, fitted["estimated"]))
    return "".join(parts)


def parameters(region: dict) -> str:
    boxes, rows = d.Material.boxes(), []
    for name, value in region["parameters"].items():
        known = "fixed" if name not in region.get("deviations", {}) else interval(region, name)
        box = "[{:g}, {:g}]".format(*boxes[name])
        rows.append([name, float(value), UNITS.get(name, "-"), known, confidence(region, name), box, warning(region, name)])
    if "width" in region:
        rows.append(["width", region["width"], "index", interval(region, "width"), confidence(region, "width"), "", ""])
    return table(["parameter", "value", "unit", "90 % interval", "confidence", "box", "warning"], rows)


def interval(region: dict, name: str) -> str:
    found = region.get("interval", {}).get(name)
    return "{:.3g} to {:.3g}".format(*found) if found else ""


def confidence(region: dict, name: str) -> str:
    return region.get("confidence", {}).get(name, "")


def warning(region: dict, name: str) -> str:
    kinds = [finding["kind"] for finding in region.get("findings", []) if finding["parameter"] == name]
    return "; ".join(f"⚠ {WARNINGS[kind]}" for kind in kinds)


def sentences(region: dict) -> list[str]:
    """What is doubtful, a sentence each."""
    return [d.FitFinding(**finding).text() for finding in region.get("findings", [])]


def energies(region: dict) -> str:
    text = f"E_fit {region['energy']:.2f} px²"
    if noise := region.get("energy_noise"):
        text += f" (± {noise:.2g} from one simulation to the next)"
    if centre := region.get("energy_at_centre"):
        change = 100 * (1 - region["energy"] / centre)
        text += f", {abs(change):.0f} % {'below' if change >= 0 else 'above'} the centre of the box ({centre:.2f} px²)"
    text += f"; {region['evaluations']} evaluations"
    return text + (f", stopped: {region['stop_reason']}." if region["stop_reason"] else ".")


def describe_confidence(region: dict) -> list[str]:
    """Which parameters the video determines; nothing if that was not measured. (The others are among the findings.)"""
    levels = region.get("confidence", {})
    words = {"high": "Well determined", "medium": "Partly determined"}
    found = {level: [NAMES[name] for name in levels if levels[name] == level] for level in words}
    return [f"{words[level]}: {', '.join(names)}." for level, names in found.items() if names]


def drawing(rows: int, height: float):
    """A figure with `rows` axes below each other, without a display; svg() makes it part of a page."""
    from matplotlib.figure import Figure  # not pyplot: whoever calls us may draw with it, in a window or a notebook

    chart = Figure(figsize=(8, height))
    return chart, chart.subplots(rows, 1, sharex=True, squeeze=False)


def svg(chart) -> str:
    from matplotlib import rc_context

    chart.tight_layout()
    buffer = io.StringIO()
    with rc_context({"svg.hashsalt": "doublet"}):  # the same chart makes the same bytes
        chart.savefig(buffer, format="svg", metadata={"Date": None})
    text = buffer.getvalue()
    return f'<div class="wide">{text[text.index("<svg") :]}</div>'


def energy_plot(log: list[dict]) -> str:
    """Inline SVG of best and generation energy over evaluations."""
    chart, ((axes,),) = drawing(1, 3.2)
    for region in sorted({row["region"] for row in log}, key=int):
        mine = [row for row in log if row["region"] == region]
        evaluations = [int(row["evaluations"]) for row in mine]
        axes.plot(
            evaluations, [float(row["generation_best"]) for row in mine], ".", label=f"region {region}: best of the generation"
        )
        axes.plot(evaluations, [float(row["best"]) for row in mine], label=f"region {region}: best so far")
    axes.set_xlabel("evaluations")
    axes.set_ylabel("E_fit, px²")
    if log:
        axes.legend(frameon=False)
    return svg(chart)


def parameter_plot(log: list[dict], names: list[str]) -> str:
    """Inline SVG of one region: the search's answer for every parameter, and its standard deviation, over evaluations."""
    chart, axes = drawing(len(names), 1.1 * len(names) + 0.5)
    evaluations = [int(row["evaluations"]) for row in log]
    for name, (axis,) in zip(names, axes):
        low, high = d.Material.boxes().get(name, (0, 1))
        mean = np.array([float(row[f"mean_{name}"]) for row in log])
        spread = (high - low) * np.array([float(row[f"deviation_{name}"]) for row in log])
        axis.fill_between(evaluations, mean - spread, mean + spread, alpha=0.25, linewidth=0)
        axis.plot(evaluations, mean)
        axis.set_ylim(low, high)
        axis.set_ylabel(f"{name}, {UNITS[name]}" if name in UNITS else name, rotation=0, ha="right")
    axes[-1, 0].set_xlabel("evaluations")
    return svg(chart)


def corner_plot(draws: np.ndarray, region: dict, names: list[str]) -> str:
    """Inline SVG: the posterior of the material, one parameter at a time and two at a time, in the box as it was searched."""
    from matplotlib.figure import Figure

    n = len(names)
    chart = Figure(figsize=(1.3 * n, 1.3 * n))
    axes = chart.subplots(n, n, sharex="col", squeeze=False)
    for i in range(n):
        for j in range(n):
            axis = axes[i, j]
            axis.set_xticks([0, 1])
            axis.set_yticks([])
            axis.set_xlim(-0.03, 1.03)
            if j > i:
                axis.set_visible(False)
            elif i == j:
                axis.hist(draws[:, i], bins=np.linspace(0, 1, 21))
            else:
                axis.plot(draws[:, j], draws[:, i], ".", markersize=2, alpha=0.4)
                axis.set_ylim(-0.03, 1.03)
                axis.set_title(f"{region['correlation'][names[i]][names[j]]:+.2f}", fontsize=7, pad=2)
            if i == n - 1:
                axis.set_xlabel(names[j], fontsize=8)
            if j == 0:
                axis.set_ylabel(names[i], fontsize=8)
    return "<p>Posterior of the material: each parameter, and each pair with its correlation.</p>" + svg(chart)


class FitPage:
    """OUT/fit_progress.html; a browser that shows it loads it again every few seconds until the search is over."""

    def __init__(self, out: Path):
        self.out, self.path = Path(out), Path(out) / "fit_progress.html"
        self.next = time.monotonic() + SECONDS_BETWEEN / 2

    def show(self, over: bool) -> None:
        start = time.monotonic()
        if not over and start < self.next:
            return
        again = "" if over else '<meta http-equiv="refresh" content="5">'
        write_text(self.path, page("fit", f"<h1>Material search</h1>{sections(self.out)}", again))
        end = time.monotonic()
        self.next = end + max(SECONDS_BETWEEN, 20 * (end - start))
