"""The claims of Stoll et al. 2010, Sect. 7 (and Fig. 5), each as a command that prints a table (docs/results.md).

    python benchmarks/sect7 recovery OUT          a known material from re-rendered images
    python benchmarks/sect7 table1 OUT            whether the energy tells the six materials of Table 1 apart
    python benchmarks/sect7 rivals OUT --truth G  the estimate against other materials
    python benchmarks/sect7 cross OUT_A OUT_B     one garment in two motions
    python benchmarks/sect7 iterations OUT        25 % fewer iterations
    python benchmarks/sect7 landscape OUT         Fig. 5a
    python benchmarks/sect7 robustness OUT        Fig. 5b
    python benchmarks/sect7 annealing OUT         CMA-ES against simulated annealing
    python benchmarks/sect7 variants OUT          beyond the paper: windows, k', larger populations, early stopping

OUT: a folder of `doublet reconstruct`; robustness, annealing and variants need it up to stage garment only. What was done is
kept in WORK (OUT/sect7) and not done again.
"""

import argparse
import sys
from pathlib import Path

import comparisons
import searches
from doublet.evaluation import metrics as evaluate
from filmed import Filming
from reconstructions import material


def filming_flags(command) -> None:
    command.add_argument("--cameras", type=int, default=0, metavar="N", help="as many of the session's (default: all)")
    command.add_argument("--frames", type=int, default=-1, metavar="N", help="default: the whole motion")
    command.add_argument("--noise", type=float, default=3.0, metavar="X", help="grey levels (default: 3)")
    command.add_argument("--perfect", action="store_true", help="no images: outlines of masks, projected points of the surface")


def search(a) -> dict:
    return {"max_evaluations": a.evaluations, "penalty": a.penalty, "population": a.population}


def filming(a) -> Filming:
    return Filming(a.cameras, a.frames, a.noise, a.perfect)


def build_parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="sect7", description=__doc__.splitlines()[0])
    commands = parser.add_subparsers(required=True)

    def add(name: str, function, run, outs: int = 1):
        text = function.__doc__.replace("%", "%%")
        command = commands.add_parser(name, help=text.splitlines()[0], description=text)
        command.add_argument("out", type=Path, nargs=outs, metavar="OUT")
        command.add_argument("--session", type=Path, nargs=outs, metavar="DIR", help="default: the one that OUT was made from")
        command.add_argument("--work", type=Path, metavar="DIR", help="what was done is kept here (default: OUT/sect7)")
        command.add_argument("--workers", type=int, default=2, metavar="N", help="processes (default: 2)")
        command.set_defaults(run=run)
        return command

    c, s = comparisons, searches
    one = lambda a: (a.out[0], a.session[0])  # noqa: E731
    command = add(
        "recovery", c.recovery,
        lambda a: c.recovery(*one(a), material(a.material), filming(a), search(a), a.seconds, a.work, a.workers),
    )  # fmt: skip
    command.add_argument("--material", type=float, nargs=5, default=[4, 4.9, 0.7, 1, 0.5], metavar="X", help="the true one")
    command.add_argument("--evaluations", type=int, default=512, metavar="N")
    command.add_argument("--penalty", type=float, default=16.0, metavar="X", help="omega (default: 16, the paper's)")
    command.add_argument("--population", type=int, default=0, metavar="N", help="default: Hansen's, 8 for five parameters")
    command.add_argument("--seconds", type=float, default=4.0, metavar="X", help="of cloth that are compared (default: 4)")
    filming_flags(command)
    filming_flags(add("table1", c.table1, lambda a: c.table1(*one(a), filming(a), a.work, a.workers)))
    command = add("rivals", c.rivals, lambda a: c.rivals(*one(a), a.truth, a.every, a.seeds, a.random, a.work, a.workers))
    command.add_argument("--truth", type=Path, required=True, metavar="DIR", help="ground_truth folder")
    command.add_argument("--every", type=int, default=1, metavar="N", help="measure every n-th frame (default: all)")
    command.add_argument("--seeds", type=int, default=1, metavar="N", help="estimates, each from a seed of its own (default: 1)")
    command.add_argument("--random", type=int, default=0, metavar="N", help="as many random materials (default: 0)")
    command = add("cross", c.cross, lambda a: c.cross(a.out, a.session, a.truth, a.work, a.workers), outs=2)
    command.add_argument("--truth", type=Path, nargs=2, default=[], metavar="DIR", help="ground_truth of both: resim_cloth_cm")
    add("iterations", c.iterations, lambda a: c.iterations(*one(a)))
    command = add("landscape", s.landscape, lambda a: s.landscape(*one(a), a.size, a.work, a.workers))
    command.add_argument("--size", type=int, default=17, metavar="N", help="samples along each axis (default: 17)")
    command = add("robustness", s.robustness, lambda a: s.robustness(*one(a), a.starts, a.evaluations, a.work, a.workers))
    command.add_argument("--starts", type=int, default=8, metavar="N")
    command.add_argument("--evaluations", type=int, default=512, metavar="N")
    command = add("annealing", s.annealing, lambda a: s.annealing(*one(a), a.seeds, a.evaluations, a.work, a.workers))
    command.add_argument("--seeds", type=int, nargs="+", default=[1, 2, 3])
    command.add_argument("--evaluations", type=int, default=256, metavar="N", help="of CMA-ES")
    command = add("variants", s.variants, lambda a: s.variants(*one(a), a.truth, a.evaluations, a.seeds, a.work, a.workers))
    command.add_argument("--truth", type=Path, metavar="DIR", help="ground_truth: resim_cloth_cm as well")
    command.add_argument("--evaluations", type=int, default=256, metavar="N")
    command.add_argument("--seeds", type=int, nargs="+", default=[1])
    return parser


def main(arguments=None) -> None:
    parsed = build_parser().parse_args(arguments)
    parsed.session = parsed.session or [None] * len(parsed.out)
    for out in parsed.out:
        if not out.is_dir():
            sys.exit(f"sect7: {out} is not a folder")
    parsed.work = parsed.work or parsed.out[0] / "sect7"
    parsed.work.mkdir(parents=True, exist_ok=True)
    try:
        parsed.run(parsed)
    except (RuntimeError, OSError, ValueError, evaluate.Missing) as error:
        sys.exit(f"sect7: {error}")


if __name__ == "__main__":
    main()
