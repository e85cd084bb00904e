#include "common.h"

#include "doublet/fit/garment_trial.h"
#include "doublet/fit/material_estimator.h"
#include "doublet/testing/optimizer_conformance.h"

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

OptimizerFactory optimizer_factory(const py::object &make) {
  const auto made = factory_from<Optimizer, int, std::uint64_t>(make, "make_optimizer must return an Optimizer");
  if (!made)
    return {};
  return [made](int dimension, std::uint64_t seed) { return std::make_unique<KeptOptimizer>(made(dimension, seed)); };
}

void bind_optimizers(py::module_ &m) {
  py::class_<OptimizerResult>(m, "OptimizerResult", "Where an optimiser stands.")
      .def(py::init<>())
      .def_readwrite("answer", &OptimizerResult::answer)
      .def_readwrite("best", &OptimizerResult::best)
      .def_readwrite("best_energy", &OptimizerResult::best_energy)
      .def_readwrite("deviations", &OptimizerResult::deviations)
      .def_readwrite("evaluations", &OptimizerResult::evaluations)
      .def_readwrite("generations", &OptimizerResult::generations)
      .def_readwrite("stop_reason", &OptimizerResult::stop_reason);
  py::class_<Optimizer, PyOptimizer>(m, "Optimizer", "Swap point: ask() a generation, tell() its energies. Box [0, 1]^n.")
      .def(py::init<>())
      .def("ask", &Optimizer::ask, Release(), "(S, n) the next generation.")
      .def("tell", &Optimizer::tell, py::arg("samples"), py::arg("energies"), Release(),
           "samples (S, n) as asked, energies (S); lower is better.")
      .def("stop", &Optimizer::stop, Release(), "Is the search over?")
      .def("result", &Optimizer::result, Release(), "Where the search stands.")
      .def("save", &Optimizer::save, Release(), "The exact state as text; empty = cannot be saved.")
      .def("restore", &Optimizer::restore, py::arg("state"), Release(),
           "Goes on where the saved optimiser stood, to the same bits.");
  OptionsClass<CmaEsOptions>(m, "CmaEsOptions", "Options of create_cma_es.")
      .field("population", &CmaEsOptions::population, "lambda; 0 = 4 + floor(3 ln n)")
      .field("initial_mean", &CmaEsOptions::initial_mean, "along every axis")
      .field("initial_sigma", &CmaEsOptions::initial_sigma, "along every axis")
      .field("max_evaluations", &CmaEsOptions::max_evaluations, "no generation begins at or beyond it")
      .field("smallest_deviation", &CmaEsOptions::smallest_deviation, "stop when all standard deviations are below it")
      .field("stagnation", &CmaEsOptions::stagnation, "stop when the energies of twenty generations change by less; 0 = never")
      .field("seed", &CmaEsOptions::seed, "of the random numbers");
  OptionsClass<AnnealingOptions>(m, "AnnealingOptions", "Options of create_simulated_annealing.")
      .field("chains", &AnnealingOptions::chains, "samples a generation")
      .field("max_evaluations", &AnnealingOptions::max_evaluations, "the schedule's length")
      .field("initial_step", &AnnealingOptions::initial_step, "box units")
      .field("final_step", &AnnealingOptions::final_step, "box units")
      .field("initial_temperature", &AnnealingOptions::initial_temperature, "fraction of the first generation's mean energy")
      .field("final_temperature", &AnnealingOptions::final_temperature, "likewise")
      .field("seed", &AnnealingOptions::seed, "of the random numbers");
  m.def("create_cma_es", &create_cma_es, py::arg("dimension"), py::arg("options") = CmaEsOptions{},
        "Covariance matrix adaptation (Hansen) over [0, 1]^dimension.");
  m.def("create_simulated_annealing", &create_simulated_annealing, py::arg("dimension"), py::arg("options") = AnnealingOptions{},
        "Independent Metropolis chains under one geometric cooling schedule, over [0, 1]^dimension.");
}

void bind_minimise(py::module_ &m) {
  py::class_<GenerationRow>(m, "GenerationRow", "One generation of one part.")
      .def_readonly("part", &GenerationRow::part)
      .def_readonly("generation", &GenerationRow::generation)
      .def_readonly("evaluations", &GenerationRow::evaluations)
      .def_readonly("best", &GenerationRow::best)
      .def_readonly("generation_best", &GenerationRow::generation_best)
      .def_readonly("mean", &GenerationRow::mean)
      .def_readonly("deviation", &GenerationRow::deviation)
      .def_readonly("seconds", &GenerationRow::seconds);
  py::class_<MinimiseResult>(m, "MinimiseResult", "Where all optimisers ended, and the way there.")
      .def_readonly("parts", &MinimiseResult::parts)
      .def_readonly("penalties", &MinimiseResult::penalties, "(parts) added for each unit of squared distance from the box")
      .def_readonly("log", &MinimiseResult::log)
      .def_readonly("seconds", &MinimiseResult::seconds);
  py::class_<Objective, PyObjective>(m, "Objective", "Swap point: energies of a whole generation in one call.")
      .def(py::init<>())
      .def("parameter_count", &Objective::parameter_count, "n, of one part.")
      .def("part_count", &Objective::part_count, "Independent parts, each with n parameters and an energy of its own.")
      .def("evaluate", &Objective::evaluate, py::arg("samples"), py::arg("context") = interruptible_context(), Release(),
           "samples (S, parts * n) in [0, 1] -> energies (S, parts)");
  m.def(
      "minimise",
      [](Objective &objective, const py::object &make_optimizer, std::uint64_t seed, double penalty, bool relative_penalty,
         const std::optional<Path> &checkpoint, const std::string &problem, const Context &context) {
        MinimiseOptions options;
        options.make_optimizer = optimizer_factory(make_optimizer);
        options.seed = seed;
        options.penalty = penalty;
        options.relative_penalty = relative_penalty;
        options.checkpoint = checkpoint.value_or(Path());
        options.problem = problem;
        const py::gil_scoped_release release;
        return minimise(objective, options, context);
      },
      py::arg("objective"), py::arg("make_optimizer") = py::none(), py::arg("seed") = 1, py::arg("penalty") = 16.0,
      py::arg("relative_penalty") = true, py::arg("checkpoint") = std::nullopt, py::arg("problem") = "",
      py::arg("context") = interruptible_context(),
      "Runs one optimiser a part of the objective until all stop. Goes on from `checkpoint` if it is there and belongs to "
      "`problem`; raises Error if it is damaged.");
}

void bind_conformance(py::module_ &m) {
  m.def(
      "optimizer_violations",
      [](const py::object &make_optimizer) {
        const OptimizerFactory make = optimizer_factory(make_optimizer);
        const py::gil_scoped_release release;
        return testing::optimizer_violations(make);
      },
      py::arg("make_optimizer"),
      "One sentence for each rule that the optimisers of make_optimizer(dimension, seed) break: shapes, seeds, a paraboloid is "
      "brought down, refusals.");
}

void bind_influence(py::module_ &m) {
  py::class_<Influence>(m, "Influence", "What each parameter, moved alone, does to the energy.")
      .def_readonly("change", &Influence::change, "(n) root mean square change of the energy over 0.4 of the box")
      .def_readonly("noise", &Influence::noise, "standard deviation of the energy at the answer")
      .def_readonly("rank", &Influence::rank, "(n) 1 = changes the energy most")
      .def_property_readonly(
          "told",
          [](const Influence &influence) {
            std::vector<bool> told;
            for (int i = 0; i < influence.change.size(); ++i)
              told.push_back(influence.told(i));
            return told;
          },
          "(n) whether the change is beyond the noise");
  m.def("measure_influence", &measure_influence, py::arg("objective"), py::arg("answers"),
        py::arg("context") = interruptible_context(), Release(), "answers (parts, n) in [0, 1] -> one Influence a part");
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
  OptionsClass<EnergyOptions>(m, "EnergyOptions", "Options of the energy E_fit.")
      .field("dt", &EnergyOptions::dt, "s, one video frame")
      .field("alpha", &EnergyOptions::alpha, "weight of the silhouettes")
      .field("beta", &EnergyOptions::beta, "weight of the texture features")
      .field("gamma", &EnergyOptions::gamma, "weight of the measured contour that no simulated rim comes near; 0 = the paper's")
      .field("same_comparisons", &EnergyOptions::same_comparisons,
             "every sample is measured on what the captured cloth shows; false = on what it shows itself (the paper's)")
      .field("settle_frames", &EnergyOptions::settle_frames, "frames to fall into place before the first")
      .field("rim_cap", &EnergyOptions::rim_cap, "longest rim distance, fraction of the larger image side")
      .field("feature_cap", &EnergyOptions::feature_cap, "longest feature distance, likewise")
      .field("fast_features", &EnergyOptions::fast_features,
             "features that the captured cloth confirms may cost as far as they move, and half of feature_cap more")
      .field("outline_size", &EnergyOptions::outline_size, "pixels of the views in which visibility is decided")
      .field("field_size", &EnergyOptions::field_size, "nodes along the larger side of a distance field")
      .field("window", &EnergyOptions::window, "frames of a window that starts from the captured surface; 0 = one rollout")
      .field("window_lead", &EnergyOptions::window_lead, "frames simulated before a window counts")
      .field("stop_margin", &EnergyOptions::stop_margin, "stop samples whose energy is this much above the middle; 0 = never");
  OptionsClass<ParameterSpace>(m, "ParameterSpace", "Which material parameters are searched.")
      .field("names", &ParameterSpace::names, "of Material")
      .field("fixed", &ParameterSpace::fixed, "gives the parameters that are not searched")
      .field("even_steps", &ParameterSpace::even_steps,
             "search where equal steps change the cloth about equally: drag = 32 u^2, k_stretch = 1 - (1 - u)^4")
      .get()
      .def("material", &ParameterSpace::material, py::arg("unit"), "The Material at a point (n) of the box.")
      .def("unit", &ParameterSpace::unit, py::arg("material"), "(n) the point of the box at which a material lies.");
  py::class_<MaterialObjective, Objective>(m, "MaterialObjective", "E_fit of Sect. 6.2 over the box of the parameter space.")
      .def(py::init<const CharacterSimulator &, const ReferencePerformance &, const Observations &, const EnergyOptions &,
                    const ParameterSpace &, const Context &>(),
           py::arg("simulator"), py::arg("performance"), py::arg("observations"), py::arg("options") = EnergyOptions{},
           py::arg("space") = ParameterSpace{}, py::arg("context") = interruptible_context(), py::keep_alive<1, 2>(), Release())
      .def("energies", &MaterialObjective::energies, py::arg("materials"), py::arg("context") = interruptible_context(),
           Release(), "(S, regions) pixels^2 of materials[sample][region], on all threads")
      .def(
          "terms",
          [](const MaterialObjective &objective, const std::vector<pbd::Material> &materials) {
            return terms_without_gil([&] { return objective.terms(materials); });
          },
          py::arg("materials"),
          "One rollout of one material a region -> one dict a region of arrays (T): silhouette, feature and contour (E_sil, "
          "E_sift "
          "and E_con, pixels^2), rims, features and points (how many)")
      .def(
          "surface_terms",
          [](const MaterialObjective &objective, const std::vector<Vertices> &surfaces) {
            return terms_without_gil([&] { return objective.surface_terms(surfaces); });
          },
          py::arg("surfaces"), "The same of surfaces (T, V, 3) that were not simulated, e.g. the captured ones")
      .def("surface_energy", &MaterialObjective::surface_energy, py::arg("surfaces"), Release(),
           "(regions) E_fit of such surfaces, pixels^2")
      .def_property_readonly("worst_energy", &MaterialObjective::worst_energy, "pixels^2: no sample costs more")
      .def_property_readonly("fingerprint", &MaterialObjective::fingerprint, "hash of everything the energy depends on")
      .def_property_readonly("space", &MaterialObjective::space);
}

void bind_garment_trial(py::module_ &m) {
  OptionsClass<TrialOptions>(m, "TrialOptions", "Which rest shapes of a garment are tried on the video.")
      .field("spreads", &TrialOptions::spreads, "tried in the place of GarmentOptions.spread; empty = none, that one is taken")
      .field("materials", &TrialOptions::materials, "that each is tried with");
  m.def("trial_samples", &trial_samples, py::arg("space"), py::arg("count"),
        "(count, n) points of the box, spread evenly, of cloth that does not stretch.");
  m.def("trial_energy", &trial_energy, py::arg("objective"), py::arg("materials") = TrialOptions{}.materials,
        py::arg("context") = interruptible_context(), Release(),
        "(regions) pixels^2: what a garment costs before its material is known, the mean of the lowest quarter of E_fit over "
        "trial_samples().");
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
    entry["spread"] = region.spread;
    entry["remarks"] = region.remarks(result.parameters);
    py::list confidence;
    for (const Confidence level : region.confidence())
      confidence.append(confidence_name(level));
    entry["confidence"] = confidence;
    entry["influence"] = region.influence;
    entry["evaluations"] = region.evaluations;
    entry["stop_reason"] = region.stop_reason;
    regions.append(entry);
  }
  py::dict dict;
  dict["parameters"] = result.parameters;
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
  bind_influence(m);
  bind_energy(m);
  bind_garment_trial(m);
  OptionsClass<FitOptions>(m, "FitOptions", "Options of estimate_material.")
      .field("seed", &FitOptions::seed, "of the search")
      .field("seeds", &FitOptions::seeds, "searches from as many different seeds; the answer is that of the lowest energy")
      .field("max_evaluations", &FitOptions::max_evaluations, "no generation begins at or beyond it")
      .field("population", &FitOptions::population, "samples a generation, 0 = 4 + floor(3 ln n)")
      .field("initial_sigma", &FitOptions::initial_sigma, "of the search, box units")
      .field("smallest_deviation", &FitOptions::smallest_deviation, "stop when all are below, box units")
      .field("stagnation", &FitOptions::stagnation, "stop when the energies of twenty generations change by less; 0 = never")
      .field("penalty", &FitOptions::penalty, "omega, of samples outside the box")
      .field("relative_penalty", &FitOptions::relative_penalty,
             "omega times the median energy of the first generation; false = omega alone (the paper's)")
      .field("answer_generations", &FitOptions::answer_generations,
             "answer the best of so many generations' means, the last ones; 1 = the final mean")
      .field("answer_best", &FitOptions::answer_best, "answer the best sample instead of a mean")
      .field("optimizer", &FitOptions::optimizer, "cma-es or annealing")
      .field("influence", &FitOptions::influence, "measure at the end what the motion tells about each parameter")
      .get()
      .def_readwrite("on_generation", &FitOptions::on_generation, "called with the FitResult so far, after every generation")
      .def_readwrite("space", &FitOptions::space)
      .def_readwrite("energy", &FitOptions::energy)
      .def_readwrite("checkpoint", &FitOptions::checkpoint)
      .def_readwrite("log", &FitOptions::log)
      .def_property(
          "make_optimizer", [](const FitOptions &) { return py::none(); },
          [](FitOptions &options, const py::object &make) { options.make_optimizer = optimizer_factory(make); },
          "make_optimizer(dimension, seed) -> Optimizer; None = CMA-ES. Cannot be read back.");
  py::class_<FitResult>(m, "FitResult", "The estimated material of every region.")
      .def_property_readonly("materials", &FitResult::materials, "one a region")
      .def_readonly("log", &FitResult::log)
      .def_readonly("seconds", &FitResult::seconds)
      .def_readonly("interrupted", &FitResult::interrupted, "the search was not over: the materials are the best samples so far")
      .def("to_dict", &result_dict, "Everything as plain values.");
  m.def("estimate_material", &estimate_material, py::arg("simulator"), py::arg("performance"), py::arg("observations"),
        py::arg("options") = FitOptions{}, py::arg("context") = interruptible_context(), Release(),
        "Searches the material of every cloth region that makes the simulated character look as in the video -> FitResult. Goes "
        "on from options.checkpoint if that is there.");
  m.def("material_energy", &material_energy, py::arg("simulator"), py::arg("performance"), py::arg("observations"),
        py::arg("materials"), py::arg("options") = EnergyOptions{}, py::arg("context") = interruptible_context(), Release(),
        "One E_fit a region, pixels^2, of one material a region.");
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
      py::arg("context") = interruptible_context(), "(T, V, 3) the reference motion re-animated");
  m.def("write_materials", &write_materials, py::arg("path"), py::arg("result"), Release(),
        "material.json, complete or not at all.");
  m.def("read_materials", &read_materials, py::arg("path"), Release(),
        "material.json: one Material a region. Raises FileNotFoundError, or Error naming file and parameter.");
}

} // namespace doublet::python
