#include "common.h"

#include "doublet/reconstruct/corrections_file.h"
#include "doublet/reconstruct/reconstruction.h"

namespace doublet::python {
namespace {

py::object plain_of(const py::object &value) {
  for (const char *method : {"tolist", "to_dict"}) // arrays and NumPy's numbers; options
    if (py::hasattr(value, method))
      return value.attr(method)();
  throw py::type_error("expected what JSON can hold, found " + described(value));
}

/// What is no finite number is null, as in a summary of C++: JSON has no other word for it.
std::string to_json(const py::object &value) {
  const py::module_ json = py::module_::import("json");
  const py::object text = json.attr("dumps")(value, py::arg("default") = py::cpp_function(&plain_of));
  const py::cpp_function null([](const py::str &) { return py::none(); });
  return json.attr("dumps")(json.attr("loads")(text, py::arg("parse_constant") = null)).cast<std::string>();
}

py::object from_json(const std::string &text) {
  return py::module_::import("json").attr("loads")(text);
}

/// A stage's work written in Python: run(reconstruction) -> dict of numbers; None = there are none.
Stage::Run run_from(const py::function &function) {
  const std::shared_ptr<py::function> kept(new py::function(function), [](py::function *held) {
    const py::gil_scoped_acquire gil;
    delete held;
  });
  return [kept](Reconstruction &reconstruction) {
    const py::gil_scoped_acquire gil;
    const py::object numbers = (*kept)(py::cast(&reconstruction, py::return_value_policy::reference));
    if (!numbers.is_none() && !py::isinstance<py::dict>(numbers))
      throw py::type_error("a stage must return a dict of numbers, or None, found " + described(numbers));
    return numbers.is_none() ? std::string("{}") : to_json(numbers);
  };
}

/// Whose work it is, for the record.
std::string runner_of(const py::function &function) {
  return py::module_::import("doublet.common.function_identity").attr("function_identity")(function).cast<std::string>();
}

/// visit(options) of the group of that name.
template <class Visit> void visit_group(ReconstructionOptions &options, const std::string &name, Visit &&visit) {
  std::string known;
  bool found = false;
  for_each_group(options, [&](const char *group, auto &values) {
    known += (known.empty() ? "" : ", ") + std::string(group);
    if (name == group) {
      found = true;
      visit(values);
    }
  });
  if (!found)
    throw py::key_error("option group '" + name + "': expected one of " + known);
}

void bind_checks(py::module_ &m) {
  py::register_exception<Implausible>(m, "Implausible", m.attr("Error"));
  Class<Limit>(m, "Limit",
               "Limits of a number in a stage's summary: lower ones if `impossible` is below `doubtful`, otherwise upper ones.")
      .def_property_readonly(
          "stage", [](const Limit &limit) { return limit.stage; }, "whose summary")
      .def_property_readonly(
          "number", [](const Limit &limit) { return limit.number; }, "name in the summary")
      .def_readonly("doubtful", &Limit::doubtful, "beyond it the number is doubtful")
      .def_readonly("impossible", &Limit::impossible, "beyond it the number is impossible")
      .def("check", &Limit::check, py::arg("value"), "The Finding; None if the number is as it should be.")
      .def("passed", &Limit::passed, py::arg("value"), "A sentence if the number is within the limits; otherwise empty.");
  m.def(
      "quality_limits", [] { return std::vector<Limit>(quality_limits().begin(), quality_limits().end()); },
      "Limits of the numbers of all stages.");
  m.def(
      "quality_findings",
      [](const std::string &stage, const py::dict &summary) { return quality_findings(stage, to_json(summary)); },
      py::arg("stage"), py::arg("summary"), "The Findings about a finished stage, from its summary.");
  m.def(
      "findings_to_json", [](const std::vector<Finding> &findings) { return from_json(findings_to_json(findings)); },
      py::arg("findings"), "The value of 'findings' in the summary of a stage: a list of dicts.");
}

void bind_corrections(py::module_ &m) {
  m.def("read_suggested_mask", &read_suggested_mask, py::arg("out"),
        "(F) bool of the template in OUT, False: suggested as invalid.");
  m.def("read_template_mask", &read_template_mask, py::arg("out"),
        "(F) bool: the edited mask if there is one, else the suggestion.");
  m.def("write_template_mask", &write_template_mask, py::arg("out"), py::arg("mask"),
        "Writes the edited mask (F), 0 or 1 each, for the template in OUT.");
  m.def("read_segmentation_paint", &read_segmentation_paint, py::arg("out"), py::arg("vertices"),
        "(V) int32 in -1 to 2, None if nothing was painted.");
  m.def("write_segmentation_paint", &write_segmentation_paint, py::arg("out"), py::arg("painted"), py::arg("vertices"),
        "Writes what was painted, -1 (as found), 0 (skin), 1 (cloth) or 2 (border) for each vertex.");
  m.def("read_found_segmentation", &read_found_segmentation, py::arg("out"), "The segmentation without corrections.");
}

void bind_record(py::module_ &m) {
  Class<RunRecord>(m, "RunRecord", "run.json: stages that were run, their inputs, options and durations.")
      .def(py::init<Path>(), py::arg("out"))
      .def_property_readonly("path", &RunRecord::path, "of run.json")
      .def_property_readonly(
          "data", [](const RunRecord &record) { return from_json(record.json()); }, "the whole record, as plain values")
      .def("hash", &RunRecord::hash, py::arg("path"), "SHA-256 of a file, or of all files in a folder.")
      .def(
          "summary", [](const RunRecord &record, const std::string &stage) { return from_json(record.summary(stage)); },
          py::arg("stage"), "The numbers of a stage; empty if it did not run.")
      .def("is_done", &RunRecord::is_done, py::arg("stage"), "Did it run to its end?")
      .def("foreign_outputs", &RunRecord::foreign_outputs, py::arg("stage"), py::arg("outputs"),
           "Outputs that exist but were not last written by this program.")
      .def(
          "reason_to_run",
          [](const RunRecord &record, const std::string &stage, const std::map<std::string, std::string> &inputs,
             const py::dict &options, const std::vector<std::string> &outputs) {
            return record.reason_to_run(stage, {inputs, to_json(options)}, outputs);
          },
          py::arg("stage"), py::arg("inputs"), py::arg("options"), py::arg("outputs"),
          "Why the stage must run, as text; empty if it is up to date.")
      .def(
          "begin",
          [](RunRecord &record, const std::string &stage, const std::map<std::string, std::string> &inputs,
             const py::dict &options) {
            record.begin(stage, {inputs, to_json(options)});
          },
          py::arg("stage"), py::arg("inputs"), py::arg("options"), "The stage runs from here.")
      .def(
          "end",
          [](RunRecord &record, const std::string &stage, const py::dict &summary, const std::vector<std::string> &outputs) {
            record.end(stage, to_json(summary), outputs);
          },
          py::arg("stage"), py::arg("summary"), py::arg("outputs"), "It is done.");
}

void bind_options(py::module_ &m) {
  std::vector<std::string> names; // one that is part of another comes behind it
  const ReconstructionOptions defaults;
  for_each_group(defaults, [&](const char *group, const auto &) { names.emplace_back(group); });
  Class<ReconstructionOptions> bound(
      m, "ReconstructionOptions",
      "Every option of a reconstruction: options[group], of the names in `groups`, and a few of all.");
  bound.attr("groups") = py::tuple(py::cast(names));
  bound.def_static("is_derived", &is_derived_option, py::arg("group"), py::arg("name"),
                   "True if the session or `seed` sets an option of a group.");
  bound.def(py::init<>())
      .def(
          "__getitem__",
          [](const py::object &self, const std::string &group) {
            py::object found;
            visit_group(self.cast<ReconstructionOptions &>(), group,
                        [&](auto &values) { found = py::cast(&values, py::return_value_policy::reference_internal, self); });
            return found;
          },
          py::arg("group"), "The options object itself, not a copy.")
      .def(
          "__setitem__",
          [](ReconstructionOptions &options, const std::string &group, const py::object &chosen) {
            visit_group(options, group, [&](auto &values) { values = chosen.cast<std::remove_cvref_t<decltype(values)>>(); });
          },
          py::arg("group"), py::arg("options"), "With its nested groups.")
      .def_readwrite("body_model", &ReconstructionOptions::body_model, "file of the statistical body")
      .def_readwrite("seed", &ReconstructionOptions::seed, "of every random choice")
      .def_readwrite("fps", &ReconstructionOptions::fps, "of the videos; 0 = as the session says")
      .def_readwrite("keep_going", &ReconstructionOptions::keep_going, "continue after results that are judged impossible")
      .def_readwrite("configuration", &ReconstructionOptions::configuration, "the file that the options are from; empty = none");
}

void bind_stage(py::module_ &m) {
  Class<Stage>(m, "Stage", "A stage: it reads and writes files in the folder of a reconstruction.")
      .def(py::init([](std::string name, const py::function &run, std::vector<std::string> reads, std::vector<std::string> writes,
                       std::vector<std::string> may_read, std::vector<std::string> may_write,
                       std::vector<std::string> option_groups, std::vector<std::string> session_inputs, bool needs_scan,
                       const std::optional<std::string> &runner) {
             Stage stage{.name = std::move(name), .reads = std::move(reads), .writes = std::move(writes)};
             stage.may_read = std::move(may_read);
             stage.may_write = std::move(may_write);
             stage.option_groups = std::move(option_groups);
             stage.session_inputs = std::move(session_inputs);
             stage.needs_scan = needs_scan;
             stage.run = run_from(run);
             stage.runner = runner ? *runner : runner_of(run);
             return stage;
           }),
           py::arg("name"), py::arg("run"), py::kw_only(), py::arg("reads") = std::vector<std::string>{},
           py::arg("writes") = std::vector<std::string>{}, py::arg("may_read") = std::vector<std::string>{},
           py::arg("may_write") = std::vector<std::string>{}, py::arg("option_groups") = std::vector<std::string>{},
           py::arg("session_inputs") = std::vector<std::string>{}, py::arg("needs_scan") = true, py::arg("runner") = py::none(),
           "run(reconstruction) does the work and returns numbers worth recording, or None. runner: its name, for the record; by "
           "default its own, and a hash of its code and of what it holds.")
      .def_readonly("name", &Stage::name, "of the stage")
      .def_readonly("reads", &Stage::reads, "files of the folder")
      .def_readonly("writes", &Stage::writes, "files of the folder")
      .def_readonly("may_read", &Stage::may_read, "optional inputs: files of the folder that are read if they exist")
      .def_readonly("may_write", &Stage::may_write,
                    "optional outputs: files of the folder that not every run writes; a run removes those of the last")
      .def_readonly("continues_from", &Stage::continues_from, "files of the folder from which an interrupted stage resumes")
      .def_readonly("option_groups", &Stage::option_groups, "groups that its results depend on")
      .def_readonly("session_inputs", &Stage::session_inputs,
                    "description, name, scan_from_views, scan, calibration, joints, keypoints, images")
      .def_readonly("runner", &Stage::runner, "name of the implementation; empty = doublet's")
      .def(
          "run",
          [](const Stage &stage, Reconstruction &reconstruction) {
            std::string summary;
            {
              const py::gil_scoped_release release;
              summary = stage.run(reconstruction);
            }
            return from_json(summary);
          },
          py::arg("reconstruction"), "Does the work, even if the stage is up to date -> its summary.");
  m.def("default_stages", &default_stages, "The stages of a reconstruction, in their order.");
}

} // namespace

void bind_reconstruct(py::module_ &m) {
  constexpr auto kInside = py::return_value_policy::reference_internal;
  bind_checks(m);
  bind_corrections(m);
  bind_record(m);
  bind_options(m);
  Class<Reconstruction> reconstruction(m, "Reconstruction", "From a capture session to an animatable character, in stages.");
  bind_stage(m);
  reconstruction
      .def(py::init<Path, Path, ReconstructionOptions, Context>(), py::arg("session"), py::arg("out"),
           py::arg("options") = ReconstructionOptions{}, py::arg("context") = interruptible_context())
      .def_readwrite("options", &Reconstruction::options, "ReconstructionOptions")
      .def_readwrite("stages", &Reconstruction::stages, "Stages in their order; a copy: assign the whole list to change it")
      .def_readwrite("announce", &Reconstruction::announce, "called with one line about each stage")
      .def(
          "replace",
          [](Reconstruction &self, const std::string &stage, const py::function &run, const std::optional<std::string> &runner) {
            self.replace(stage, run_from(run), runner ? *runner : runner_of(run));
          },
          py::arg("stage"), py::arg("run"), py::arg("runner") = py::none(),
          "Replaces the implementation of a stage by run(reconstruction), which returns numbers for run.json; it must write the "
          "same files. runner: its name, for the record; by default its own, and a hash of its code and of what it holds.")
      .def("run", &Reconstruction::run, py::arg("names"), py::arg("force") = false, Release(),
           "Runs the named stages unless they are up to date. Returns whether any ran.")
      .def("run_all", &Reconstruction::run_all, py::arg("force") = false, Release(),
           "Runs all stages unless they are up to date. Returns whether any ran.")
      .def_property_readonly("findings", &Reconstruction::findings, "Findings about the stages of the last run()")
      .def_property_readonly("session_folder", &Reconstruction::session_folder, "as it was given")
      .def_property_readonly("out", &Reconstruction::out, "folder of the results")
      .def("path", &Reconstruction::path, py::arg("file"), "of a file of `out`")
      .def_property_readonly("context", &Reconstruction::context, "Context, whose log is also written to log.txt")
      .def_property(
          "session", [](Reconstruction &self) { return self.session(); }, &Reconstruction::set_session,
          "Session, read at the first access; read again by run() if its files have changed")
      .def("reread_session", &Reconstruction::reread_session, "Reads the session again after its files were changed.")
      .def_property_readonly("filmed", &Reconstruction::filmed, "the session with the refined cameras, if there are any")
      .def_property_readonly("silhouettes", &Reconstruction::silhouettes, kInside,
                             "SilhouetteExtractor, trained with the current options; None if all cameras have ready masks")
      .def_property_readonly("results", &Reconstruction::results, kInside, "Results of the stages")
      .def_property_readonly("record", &Reconstruction::record, kInside, "RunRecord")
      .def("solver_settings", &Reconstruction::solver_settings, "SolverSettings for which materials are estimated.")
      .def("fit_options", &Reconstruction::fit_options, "FitOptions with the seed of the options.");
  m.def(
      "fit_together",
      [](const std::vector<Reconstruction *> &reconstructions) {
        fit_together(require_objects(reconstructions, "reconstructions"));
      },
      py::arg("reconstructions"), Release(),
      "Estimates one material, and one width, for several takes of one garment, with the options and the seed of the first.");
}

} // namespace doublet::python
