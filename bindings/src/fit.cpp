#include "common.h"

#include "doublet/fit/material_estimator.h"
#include "doublet/fit/results.h"
#include "doublet/testing/objective_conformance.h"
#include "doublet/testing/optimizer_conformance.h"

#include <pybind11/typing.h>

namespace doublet::python {
namespace {

class PyOptimizer : public Optimizer {
public:
  MatrixRM ask() override { return call<MatrixRM>("Optimizer.ask", "samples (S, n)"); }
  void tell(const MatrixRM &samples, const Eigen::VectorXd &energies) override {
    call<py::object>("Optimizer.tell", "nothing", samples, energies);
  }
  bool stop() const override { return call<bool>("Optimizer.stop", "a bool"); }
  OptimizerResult result() const override { return call<OptimizerResult>("Optimizer.result", "an OptimizerResult"); }
  std::string save() const override { PYBIND11_OVERRIDE(std::string, Optimizer, save, ); }
  void restore(const std::string &state) override { PYBIND11_OVERRIDE(void, Optimizer, restore, state); }

private:
  template <class R, class... Arguments> R call(const std::string &where, const char *expected, Arguments &&...arguments) const {
    return call_override<R>(static_cast<const Optimizer *>(this), where, expected, std::forward<Arguments>(arguments)...);
  }
};

class PyObjective : public Objective {
public:
  int parameter_count() const override { PYBIND11_OVERRIDE_PURE(int, Objective, parameter_count, ); }
  int part_count() const override { PYBIND11_OVERRIDE(int, Objective, part_count, ); }
  MatrixRM evaluate(const MatrixRM &samples, const Context &context) override {
    return call_override<MatrixRM>(static_cast<const Objective *>(this), "Objective.evaluate", "energies (S, parts)", samples,
                                   context);
  }
};

/// Keeps the Python optimiser alive for as long as C++ owns it; every call goes through the C++ object inside.
class KeptOptimizer : public Optimizer {
public:
  explicit KeptOptimizer(std::shared_ptr<Optimizer> inner) : inner_(std::move(inner)) {}
  MatrixRM ask() override { return inner_->ask(); }
  void tell(const MatrixRM &samples, const Eigen::VectorXd &energies) override { inner_->tell(samples, energies); }
  bool stop() const override { return inner_->stop(); }
  OptimizerResult result() const override { return inner_->result(); }
  std::string save() const override { return inner_->save(); }
  void restore(const std::string &state) override { inner_->restore(state); }

private:
  std::shared_ptr<Optimizer> inner_;
};

using OptimizerMaker = py::typing::Optional<py::typing::Callable<Optimizer(int, std::uint64_t)>>;

OptimizerFactory optimizer_factory(const py::object &make) {
  const auto made = factory_from<Optimizer, int, std::uint64_t>(make, "make_optimizer must return an Optimizer");
  if (!made)
    return {};
  return [made](int dimension, std::uint64_t seed) { return std::make_unique<KeptOptimizer>(made(dimension, seed)); };
}

void bind_optimizers(py::module_ &m) {
  Class<OptimizerResult>(m, "OptimizerResult", "Where an optimiser stands.")
      .def(py::init<>())
      .def_readwrite("answer", &OptimizerResult::answer,
                     "(n) what the method returns: CMA-ES the mean of its distribution, annealing the best sample")
      .def_readwrite("best", &OptimizerResult::best, "(n) best sample so far")
      .def_readwrite("best_energy", &OptimizerResult::best_energy, "its energy; meaningless while evaluations is 0")
      .def_readwrite("deviations", &OptimizerResult::deviations, "(n) standard deviation of the search along each axis")
      .def_readwrite("evaluations", &OptimizerResult::evaluations, "evaluated samples so far")
      .def_readwrite("generations", &OptimizerResult::generations, "generations so far")
      .def_readwrite("stop_reason", &OptimizerResult::stop_reason, "empty while it runs");
  Class<Optimizer, PyOptimizer>(m, "Optimizer", "Swap point: ask() a generation, tell() its energies. Box [0, 1]^n.")
      .def(py::init<>())
      .def("ask", &Optimizer::ask, Release(), "(S, n) the next generation.")
      .def("tell", &Optimizer::tell, py::arg("samples"), py::arg("energies"), Release(),
           "samples (S, n) from ask(), energies (S); lower is better.")
      .def("stop", &Optimizer::stop, Release(), "Is the search over?")
      .def("result", &Optimizer::result, Release(), "Where the search stands.")
      .def("save", &Optimizer::save, Release(), "The exact state as text; empty = cannot be saved.")
      .def("restore", &Optimizer::restore, py::arg("state"), Release(),
           "Continues as the saved optimiser would have, with the same bits.");
  OptionsClass<CmaEsOptions>(m, "Options of create_cma_es.");
  OptionsClass<AnnealingOptions>(m, "Options of create_simulated_annealing.");
  OptionsClass<BayesianOptions>(m, "Options of create_bayesian.")
      .get()
      .def_readwrite("first", &BayesianOptions::first, "(K, n) samples of the first generation; empty = spread evenly");
  m.def("create_bayesian", &create_bayesian, py::arg("dimension"), py::arg("options") = BayesianOptions{},
        "Bayesian optimisation by Thompson sampling over [0, 1]^dimension: for energies that are expensive and noisy.");
  m.def("create_cma_es", &create_cma_es, py::arg("dimension"), py::arg("options") = CmaEsOptions{},
        "Covariance matrix adaptation (Hansen) over [0, 1]^dimension.");
  m.def("create_simulated_annealing", &create_simulated_annealing, py::arg("dimension"), py::arg("options") = AnnealingOptions{},
        "Independent Metropolis chains under one geometric cooling schedule, over [0, 1]^dimension.");
}

void bind_minimise(py::module_ &m) {
  Class<GenerationRow>(m, "GenerationRow", "One generation of one part.")
      .def_readonly("part", &GenerationRow::part, "of the objective")
      .def_readonly("generation", &GenerationRow::generation, "from 0")
      .def_readonly("evaluations", &GenerationRow::evaluations, "so far")
      .def_readonly("best", &GenerationRow::best, "lowest energy so far")
      .def_readonly("generation_best", &GenerationRow::generation_best, "lowest energy of this generation")
      .def_readonly("mean", &GenerationRow::mean, "(n) the optimiser's current answer, in [0, 1]")
      .def_readonly("deviation", &GenerationRow::deviation, "(n) standard deviation of the search along each axis")
      .def_readonly("seconds", &GenerationRow::seconds, "s since the start, including the time before a resume");
  Class<MinimiseResult>(m, "MinimiseResult", "Results of all optimisers, with all samples.")
      .def_readonly("parts", &MinimiseResult::parts, "OptimizerResult of each part")
      .def_readonly("penalties", &MinimiseResult::penalties, "(parts) penalty per unit of squared distance from the box")
      .def_readonly("log", &MinimiseResult::log, "GenerationRows")
      .def_readonly("seconds", &MinimiseResult::seconds, "s, including the time before a resume");
  Class<Objective, PyObjective>(m, "Objective", "Swap point: energies of a whole generation in one call.")
      .def(py::init<>())
      .def("parameter_count", &Objective::parameter_count, "n, of one part.")
      .def("part_count", &Objective::part_count, "Number of independent parts, each with n parameters and its own energy.")
      .def("evaluate", &Objective::evaluate, py::arg("samples"), py::arg("context") = interruptible_context(), Release(),
           "samples (S, parts * n) in [0, 1] -> energies (S, parts)");
  OptionsClass<MinimiseOptions>(m, "Options of minimise.")
      .get()
      .def_readwrite("checkpoint", &MinimiseOptions::checkpoint,
                     "written after every generation, read at the start if it is there; empty = none")
      .def_readwrite("problem", &MinimiseOptions::problem,
                     "name of the problem that the checkpoint belongs to; one of another problem is ignored")
      .def_readwrite("on_generation", &MinimiseOptions::on_generation, "called with the MinimiseResult so far")
      .def_property(
          "make_optimizer", [](const MinimiseOptions &) { return OptimizerMaker(py::none()); },
          [](MinimiseOptions &options, const OptimizerMaker &make) { options.make_optimizer = optimizer_factory(make); },
          "make_optimizer(dimension, seed) -> Optimizer; None = CMA-ES. Cannot be read back.");
  m.def("minimise", &minimise, py::arg("objective"), py::arg("options") = MinimiseOptions{},
        py::arg("context") = interruptible_context(), Release(),
        "Runs one optimiser per part of the objective until all stop. Resumes from options.checkpoint if it exists and belongs "
        "to options.problem; raises Error if it is damaged.");
}

void bind_conformance(py::module_ &m) {
  m.def("objective_violations", &testing::objective_violations, py::arg("objective"), Release(),
        "One sentence for each rule that an Objective breaks: shapes, finite energies, the same in every call and whatever the "
        "other samples, refusals.");
  m.def(
      "optimizer_violations",
      [](const OptimizerMaker &make_optimizer) {
        const OptimizerFactory make = optimizer_factory(make_optimizer);
        const py::gil_scoped_release release;
        return testing::optimizer_violations(make);
      },
      py::arg("make_optimizer"),
      "One sentence for each rule that the optimisers of make_optimizer(dimension, seed) break: shapes, seeds, a paraboloid is "
      "minimised, refusals.");
}

void bind_posterior(py::module_ &m) {
  Class<Posterior>(m, "Posterior", "Posterior over the answer: draws from a Gibbs posterior.")
      .def_readonly("draws", &Posterior::draws, "(D, n) box units")
      .def_readonly("interval", &Posterior::interval, "(n, 2) the shortest interval with 90 % of the draws, box units")
      .def_readonly("correlation", &Posterior::correlation, "(n, n) of the draws");
  m.def(
      "posterior_of",
      [](const MatrixRM &samples, const Eigen::VectorXd &energies, double noise, int levels, int draws, std::uint64_t seed) {
        return posterior_of(samples, energies, {noise, levels, draws, seed});
      },
      py::arg("samples"), py::arg("energies"), py::arg("noise") = 0.0, py::arg("levels") = 0, py::arg("draws") = 256,
      py::arg("seed") = 1, Release(),
      "samples (N, n) in [0, 1], energies (N) -> Posterior of the minimum's position. noise: standard deviation of an energy.");
}

/// One dict a region of arrays (T), from [R][T].
py::list terms_list(const std::vector<std::vector<FrameTerms>> &terms) {
  py::list regions;
  for (const std::vector<FrameTerms> &frames : terms) {
    const auto column = [&](auto FrameTerms::*member) {
      using Value = std::remove_cvref_t<decltype(frames[0].*member)>;
      py::array_t<Value> values(static_cast<py::ssize_t>(frames.size()));
      for (std::size_t t = 0; t < frames.size(); ++t)
        values.mutable_at(static_cast<py::ssize_t>(t)) = frames[t].*member;
      return values;
    };
    py::dict region;
    region["silhouette"] = column(&FrameTerms::silhouette);
    region["feature"] = column(&FrameTerms::feature);
    region["contour"] = column(&FrameTerms::contour);
    region["rims"] = column(&FrameTerms::rims);
    region["features"] = column(&FrameTerms::features);
    region["points"] = column(&FrameTerms::points);
    region["surface"] = column(&FrameTerms::surface);
    region["probes"] = column(&FrameTerms::probes);
    regions.append(region);
  }
  return regions;
}

/// The terms, worked out without the GIL.
template <class Call> py::list terms_without_gil(const Call &call) {
  std::vector<std::vector<FrameTerms>> terms;
  {
    const py::gil_scoped_release release;
    terms = call();
  }
  return terms_list(terms);
}

void bind_energy(py::module_ &m) {
  OptionsClass<EnergyOptions>(m, "Options of the energy E_fit.");
  OptionsClass<ParameterSpace>(m, "Which material parameters are searched.")
      .get()
      .def("material", &ParameterSpace::material, py::arg("unit"), "The Material at a point (n) of the box.")
      .def("unit", &ParameterSpace::unit, py::arg("material"), "(n) the point of the box at which a material lies.");
  Class<MaterialObjective, Objective>(m, "MaterialObjective", "E_fit of Sect. 6.2 over the box of the parameter space.")
      .def(py::init<const CharacterSimulator &, const ReferencePerformance &, const Observations &, double, const EnergyOptions &,
                    const ParameterSpace &, const Context &>(),
           py::arg("simulator"), py::arg("performance"), py::arg("observations"), py::arg("dt"),
           py::arg("options") = EnergyOptions{}, py::arg("space") = ParameterSpace{},
           py::arg("context") = interruptible_context(), Release())
      .def(py::init([](const py::list &widths, const ReferencePerformance &performance, const Observations &observations,
                       double dt, const EnergyOptions &options, const ParameterSpace &space, const Context &context) {
             const auto simulators = require_objects(widths.cast<std::vector<const CharacterSimulator *>>(), "widths");
             const py::gil_scoped_release release;
             return std::make_unique<MaterialObjective>(simulators, performance, observations, dt, options, space, context);
           }),
           py::arg("widths"), py::arg("performance"), py::arg("observations"), py::arg("dt"),
           py::arg("options") = EnergyOptions{}, py::arg("space") = ParameterSpace{},
           py::arg("context") = interruptible_context())
      .def_property_readonly("width_count", &MaterialObjective::width_count, "widths of the garment to choose from")
      .def("energies", &MaterialObjective::energies, py::arg("materials"), py::arg("context") = interruptible_context(),
           Release(), "(S, regions) pixels^2 of materials[sample][region], on all threads")
      .def(
          "terms",
          [](const MaterialObjective &objective, const std::vector<pbd::Material> &materials) {
            return terms_without_gil([&] { return objective.terms(materials); });
          },
          py::arg("materials"),
          "One rollout with one material per region -> one dict per region with arrays (T): silhouette, feature, contour and "
          "surface (E_sil, E_sift, E_con and E_surf, pixels^2), and the counts rims, features, points and probes")
      .def(
          "surface_terms",
          [](const MaterialObjective &objective, const std::vector<Vertices> &surfaces) {
            return terms_without_gil([&] { return objective.surface_terms(surfaces); });
          },
          py::arg("surfaces"), "The same for given surfaces (T, V, 3), e.g. the captured ones")
      .def("surface_energy", &MaterialObjective::surface_energy, py::arg("surfaces"), Release(),
           "(regions) E_fit of given surfaces, pixels^2")
      .def_property_readonly("worst_energy", &MaterialObjective::worst_energy, "upper bound of E_fit, pixels^2")
      .def_property_readonly("fingerprint", &MaterialObjective::fingerprint, "hash of everything the energy depends on")
      .def_property_readonly("space", &MaterialObjective::space, "ParameterSpace: which parameters are searched");
}

void bind_findings(py::module_ &m) {
  Class<FitFinding>(m, "FitFinding", "A doubt about a parameter of an answer.")
      .def(py::init([](const std::string &kind, const std::string &parameter, double value, double low, double high) {
             if (!std::isfinite(value) || !std::isfinite(low) || !std::isfinite(high))
               throw std::invalid_argument("FitFinding: expected finite numbers, found NaN or infinity");
             return FitFinding{finding_kind(kind), parameter, value, low, high};
           }),
           py::arg("kind"), py::arg("parameter"), py::arg("value"), py::arg("low"), py::arg("high"))
      .def_property_readonly(
          "kind", [](const FitFinding &finding) { return finding_name(finding.kind); },
          "'lower_bound', 'upper_bound', 'guess' or 'seeds'")
      .def_readonly("parameter", &FitFinding::parameter, "its name")
      .def_readonly("value", &FitFinding::value, "the answer")
      .def_readonly("low", &FitFinding::low, "bounds: of the box; guess: of its 90 % interval; seeds: of the answers")
      .def_readonly("high", &FitFinding::high, "upper bound, as `low`")
      .def("text", &FitFinding::text, "One sentence.");
}

/// A take as Python has it; the objects live as long as this.
struct PyTake {
  py::list widths;
  py::object performance, observations;
  double dt;
  Take take() const {
    return {require_objects(widths.cast<std::vector<const CharacterSimulator *>>(), "widths"),
            &performance.cast<const ReferencePerformance &>(), &observations.cast<const Observations &>(), dt};
  }
};

void bind_results(py::module_ &m) {
  constexpr auto kCopy = py::return_value_policy::copy; // they outlive forget()
  Class<Results>(m, "Results", "The results of the stages in a folder, read on demand.")
      .def(py::init<Path>(), py::arg("out"))
      .def("path", &Results::path, py::arg("file"), "of a file of the folder")
      .def("forget", &Results::forget, "Clears the cache; call it after files were written.")
      .def("set_widths", &Results::set_widths, py::arg("positions"),
           "Sets the garment's widths to these positions until forget(), overriding material.json.")
      .def_property_readonly("actor", &Results::actor, kCopy, "RiggedMesh")
      .def("performance", &Results::performance, "ReferencePerformance of the actor.")
      .def("observations", &Results::observations, "Observations of the film.")
      .def("segmentation", &Results::segmentation, "Segmentation of the actor.")
      .def("body", &Results::body, "BodyFit under the clothes.")
      .def("proxies", &Results::proxies, "TaperedCapsules of the body.")
      .def_property_readonly("offered_garment", &Results::offered_garment, kCopy,
                             "Garment from the mesher, with all widths to choose from")
      .def_property_readonly("garment", &Results::garment, kCopy,
                             "Garment in the width that was estimated with the material, or else in the middle one")
      .def_property_readonly("dressed", &Results::dressed, kCopy, "DressedActor, which is simulated: the actor in `garment`")
      .def("dressed_performance", &Results::dressed_performance,
           "ReferencePerformance of the dressed actor, the same for all widths.")
      .def("simulator", &Results::simulator, py::arg("cloth") = pbd::ClothOptions{}, "CharacterSimulator of `dressed`.")
      .def(
          "take",
          [](Results &results, const SolverSettings &solver, const std::vector<Garment> &garments) {
            FilmedTake film = results.take(solver, garments);
            py::list widths;
            for (CharacterSimulator &width : film.widths)
              widths.append(py::cast(std::move(width)));
            return PyTake{widths, py::cast(std::move(film.performance)), py::cast(std::move(film.observations)), film.dt};
          },
          py::arg("solver"), py::arg("garments") = std::vector<Garment>{},
          "The Take for the material estimation, in each of these widths; empty = all widths of the garment.");
}

py::dict result_dict(const FitResult &result) {
  py::list regions;
  for (const RegionFit &region : result.regions) {
    py::dict entry;
    entry["material"] = region.material;
    entry["energy"] = region.energy;
    entry["energy_at_centre"] = region.energy_at_centre;
    entry["best"] = region.best;
    entry["best_energy"] = region.best_energy;
    entry["deviations"] = region.deviations;
    entry["spread"] = region.answer_half_range;
    entry["answer"] = region.answer;
    entry["width"] = region.width;
    entry["energy_noise"] = region.energy_noise;
    entry["findings"] = region.findings(result.space);
    py::list confidence;
    for (const Confidence level : region.confidence())
      confidence.append(confidence_name(level));
    entry["confidence"] = confidence;
    entry["posterior"] = region.posterior;
    entry["evaluations"] = region.evaluations;
    entry["stop_reason"] = region.stop_reason;
    regions.append(entry);
  }
  py::dict dict;
  dict["parameters"] = result.parameters();
  dict["regions"] = regions;
  dict["seconds"] = result.seconds;
  dict["interrupted"] = result.interrupted;
  return dict;
}

} // namespace

void bind_fit(py::module_ &m) {
  bind_optimizers(m);
  bind_minimise(m);
  bind_conformance(m);
  bind_posterior(m);
  bind_energy(m);
  bind_findings(m);
  OptionsClass<FitOptions>(m, "Options of estimate_material.")
      .get()
      .def_readwrite("on_generation", &FitOptions::on_generation, "called with the FitResult so far, after every generation")
      .def_readwrite("checkpoint", &FitOptions::checkpoint,
                     "file from which an interrupted run resumes, with the same bits; empty = none")
      .def_readwrite("log", &FitOptions::log, "fit_log.csv, rewritten after every generation; empty = none")
      .def_property(
          "make_optimizer", [](const FitOptions &) { return OptimizerMaker(py::none()); },
          [](FitOptions &options, const OptimizerMaker &make) { options.make_optimizer = optimizer_factory(make); },
          "make_optimizer(dimension, seed) -> Optimizer; None = the one that `optimizer` names. Cannot be read back.");
  Class<PyTake>(
      m, "Take",
      "One captured performance of a character: simulators (one per width of its garment), performance and observations.")
      .def(py::init([](const py::list &widths, const py::object &performance, const py::object &observations, double dt) {
             PyTake take{widths, performance, observations, dt};
             take.take(); // wrong types are found now
             return take;
           }),
           py::arg("widths"), py::arg("performance"), py::arg("observations"), py::arg("dt"));
  Class<FitResult>(m, "FitResult", "The estimated material of every region.")
      .def_property_readonly("materials", &FitResult::materials, "one per region")
      .def_property_readonly("chosen_widths", &FitResult::chosen_widths,
                             "position of the garment's width, one per region; may be empty")
      .def("at_positions", &FitResult::at_positions, py::arg("positions"),
           "The same result for a take whose garment was simulated at these positions among its widths (see common_widths).")
      .def_readonly("log", &FitResult::log, "GenerationRows; part = region")
      .def_readonly("solver", &FitResult::solver, "SolverSettings for which the materials are valid")
      .def_readonly("seconds", &FitResult::seconds, "s, including the time before a resume")
      .def_readonly("interrupted", &FitResult::interrupted,
                    "the search was not finished: the materials are the best samples so far")
      .def("to_dict", &result_dict, "Everything as plain values.");
  m.def(
      "estimate_material",
      [](const std::vector<const PyTake *> &takes, const FitOptions &options, const Context &context) {
        std::vector<Take> all;
        for (const PyTake *take : require_objects(takes, "takes"))
          all.push_back(take->take());
        const py::gil_scoped_release release;
        return estimate_material(all, options, context);
      },
      py::arg("takes"), py::arg("options") = FitOptions{}, py::arg("context") = interruptible_context(),
      "The material, and the width of the garment, that best explain several takes together -> FitResult.");
  m.def("estimate_material",
        py::overload_cast<const CharacterSimulator &, const ReferencePerformance &, const Observations &, double,
                          const FitOptions &, const Context &>(&estimate_material),
        py::arg("simulator"), py::arg("performance"), py::arg("observations"), py::arg("dt"), py::arg("options") = FitOptions{},
        py::arg("context") = interruptible_context(), Release(),
        "Searches for the material of every cloth region with which the simulated character looks as in the video -> FitResult. "
        "Resumes from options.checkpoint if it exists.");
  bind_results(m);
  m.def("material_energy", &material_energy, py::arg("simulator"), py::arg("performance"), py::arg("observations"), py::arg("dt"),
        py::arg("materials"), py::arg("options") = EnergyOptions{}, py::arg("context") = interruptible_context(), Release(),
        "(regions) E_fit, pixels^2, of one material per region.");
  m.def(
      "simulate_reference",
      [](const CharacterSimulator &simulator, const ReferencePerformance &performance,
         const std::vector<pbd::Material> &materials, double dt, int settle_frames, const Context &context) {
        std::vector<Vertices> frames;
        {
          const py::gil_scoped_release release;
          frames = simulate_reference(simulator, performance, materials, dt, settle_frames, context);
        }
        return stack(frames);
      },
      py::arg("simulator"), py::arg("performance"), py::arg("materials"), py::arg("dt"), py::arg("settle_frames") = 20,
      py::arg("context") = interruptible_context(), "(T, V, 3) m, the reference motion simulated with these materials");
  m.def(
      "write_simulated",
      [](const Path &path, const py::array_t<double, py::array::c_style | py::array::forcecast> &frames, int actor_vertices) {
        const std::vector<Vertices> surfaces = unstack(frames, "frames");
        const py::gil_scoped_release release;
        write_simulated(path, surfaces, actor_vertices);
      },
      py::arg("path"), py::arg("frames"), py::arg("actor_vertices"),
      "simulated.npz: frames (T, V + G, 3), of which the first actor_vertices (V) are the actor's, the others the garment's.");
  m.def(
      "read_simulated", [](const Path &path) { return stack(read_simulated(path)); }, py::arg("path"),
      "simulated.npz: (T, V + G, 3), the actor's vertices, then the garment's.");
  m.def("write_materials", &write_materials, py::arg("path"), py::arg("result"), Release(), "Writes material.json atomically.");
  m.def("read_widths", &read_widths, py::arg("path"), Release(),
        "material.json: position of the garment's width, one per region; empty if it names none.");
  m.def("read_materials", &read_materials, py::arg("path"), py::arg("solver") = std::nullopt, Release(),
        "material.json: one Material per region. Raises FileNotFoundError, or Error naming file and parameter, or the solver "
        "setting that differs from the file's.");
}

} // namespace doublet::python
