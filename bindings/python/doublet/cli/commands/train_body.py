"""`doublet train-body`: registered meshes -> statistical body model."""

from __future__ import annotations

from pathlib import Path

from ... import _doublet as d
from ..common_flags import common_flags, make_console
from ..option_flags import add_option_flags, chosen_options


def register(commands) -> None:
    text = "registered meshes -> statistical body model"
    train = commands.add_parser("train-body", help=text, description=text)
    train.add_argument("population", type=Path, metavar="POPULATION.npz", help="its arrays: docs/body-model.md")
    train.add_argument("-o", "--out", type=Path, required=True, metavar="MODEL.npz", help="the model")
    common_flags(train)
    add_option_flags(train, {"train": d.TrainOptions})
    train.set_defaults(run=run)


def run(arguments) -> None:
    options = chosen_options(arguments, {"train": d.TrainOptions})["train"]
    options.command = f"doublet train-body {arguments.population.name} -o {arguments.out.name}"
    console = make_console(arguments)
    summary = d.train_body_model(arguments.population, arguments.out, options, console.context())
    console.finish()
    print(
        f"{arguments.out}: {summary.components} shape components of {summary.meshes} meshes, "
        f"{100 * summary.variance_kept:.2f} % of the variance, {summary.reconstruction_mm:.2f} mm mean vertex error"
    )
