#pragma once
// Cloth solvers from Python, for every binding file that takes one.

#include "common.h"
#include "doublet/pbd/cloth_solver.h"

#include <pybind11/typing.h>

namespace doublet::python {

using SolverMaker = py::typing::Optional<py::typing::Callable<pbd::ClothSolver(pbd::ClothModel)>>;

/// Wraps `make_solver(model) -> ClothSolver`; None = ours.
pbd::ClothSolverFactory solver_factory(const py::object &make);

} // namespace doublet::python
