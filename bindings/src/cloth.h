#pragma once
// Cloth solvers from Python, for every binding file that takes one.

#include "common.h"
#include "doublet/pbd/cloth_solver.h"

namespace doublet::python {

/// Wraps `make_solver(model) -> ClothSolver`; None = ours.
pbd::ClothSolverFactory solver_factory(const py::object &make);

} // namespace doublet::python
