#pragma once
// Every option of a reconstruction, in the groups that the command line, configuration files and run.json name.

#include "doublet/animate/texture_baker.h"
#include "doublet/bodymodel/body_fitter.h"
#include "doublet/bodymodel/proxies.h"
#include "doublet/capture/performance_capture.h"
#include "doublet/capture/silhouette_extractor.h"
#include "doublet/capture/template_builder.h"
#include "doublet/fit/material_estimator.h"
#include "doublet/pbd/cloth_solver.h"
#include "doublet/segment/cloth_segmenter.h"
#include "doublet/segment/garment_mesher.h"

#include <cstdint>
#include <string>

namespace doublet {

struct ReconstructionOptions {
  Path body_model;           ///< file of the statistical body (see BodyModel::read), for the stages `segment` and `body`
  std::uint64_t seed = 1;    ///< of all random numbers, instead of the seeds in the groups
  double fps = 0;            ///< of the videos; 0 = as the session says
  bool keep_going = false;   ///< continue after results that are judged impossible
  Path configuration = {};   ///< the file that the options are from, for the record; empty = none
  TemplateOptions template_; ///< group "template"
  SilhouetteOptions silhouette;
  CaptureOptions capture;
  SegmentOptions segment;
  BodyFitOptions body;
  ProxyOptions proxy;
  GarmentOptions garment;
  pbd::ClothOptions cloth;
  FitOptions fit;
  TextureOptions texture;
};

/// visit(name, group) for every group of options; a nested group, such as `pose` of `capture`, follows the one that contains it.
template <class Options, class Visit> void for_each_group(Options &options, Visit &&visit) {
  visit("template", options.template_);
  visit("silhouette", options.silhouette);
  visit("key", options.silhouette.key);
  visit("background", options.silhouette.background);
  visit("capture", options.capture);
  visit("features", options.capture.features);
  visit("pose", options.capture.pose);
  visit("limbs", options.capture.limbs);
  visit("annealing", options.capture.limbs.annealing);
  visit("surface", options.capture.surface);
  visit("calibration", options.capture.calibration);
  visit("segment", options.segment);
  visit("opposite", options.segment.opposite);
  visit("body", options.body);
  visit("proxy", options.proxy);
  visit("garment", options.garment);
  visit("cloth", options.cloth);
  visit("fit", options.fit);
  visit("energy", options.fit.energy);
  visit("space", options.fit.space);
  visit("texture", options.texture);
}

/// True if ReconstructionOptions::seed sets the option.
inline bool is_derived_option(const std::string &group, const std::string &name) {
  return (group == "fit" || group == "annealing") && name == "seed";
}

} // namespace doublet
