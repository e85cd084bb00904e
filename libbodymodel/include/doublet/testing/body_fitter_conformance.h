#pragma once
// What every BodyFitter must do, for those who write their own: call it in a test of any framework and expect an empty list.

#include "doublet/bodymodel/body_fitter.h"

#include <exception>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

namespace doublet::testing {

/// One sentence for each rule that the fitter breaks on an actor, a segmentation, a model and landmarks of yours: the body has
/// the model's vertices, faces and coefficients, all of it is finite, it stands where the actor does, two calls give the same
/// bits, too few landmarks and a segmentation of another mesh are refused.
inline std::vector<std::string> body_fitter_violations(const BodyFitter &fitter, const RiggedMesh &actor,
                                                       const Segmentation &segmentation, const BodyModel &model,
                                                       const std::map<std::string, Eigen::Vector3d> &landmarks) {
  std::vector<std::string> broken;
  const auto expect = [&](bool holds, const std::string &otherwise) {
    if (!holds)
      broken.push_back(otherwise);
  };
  const auto same = [](const auto &a, const auto &b) { return a.rows() == b.rows() && a == b; };
  try {
    const BodyFit fit = fitter.fit(actor, segmentation, model, landmarks, {}),
                  again = fitter.fit(actor, segmentation, model, landmarks, {});
    expect(fit.body.vertices.rows() == model.vertex_count() && fit.body.faces.rows() == model.faces().rows(),
           "expected " + std::to_string(model.vertex_count()) + " vertices and " + std::to_string(model.faces().rows()) +
               " faces, those of the model, found " + std::to_string(fit.body.vertices.rows()) + " and " +
               std::to_string(fit.body.faces.rows()));
    expect(fit.body.vertices.allFinite() && fit.coefficients.allFinite() && fit.residual >= 0,
           "expected finite vertices and coefficients and a residual of at least 0");
    const auto low = [](const Vertices &v) -> Eigen::RowVector3d { return v.colwise().minCoeff(); };
    const auto high = [](const Vertices &v) -> Eigen::RowVector3d { return v.colwise().maxCoeff(); };
    const double most = 0.4 * (high(actor.mesh.vertices) - low(actor.mesh.vertices)).maxCoeff();
    expect(fit.body.vertices.rows() > 0 && (low(fit.body.vertices) - low(actor.mesh.vertices)).cwiseAbs().maxCoeff() < most &&
               (high(fit.body.vertices) - high(actor.mesh.vertices)).cwiseAbs().maxCoeff() < most,
           "the body does not stand where the actor does");
    expect(same(fit.body.vertices, again.body.vertices) && same(fit.coefficients, again.coefficients),
           "a second call gives other bits");
  } catch (const std::exception &error) {
    broken.push_back(std::string("the fitter threw: ") + error.what());
  }
  try {
    RiggedMesh nameless = actor; // neither landmarks nor joints that the model knows
    for (std::size_t j = 0; j < nameless.skeleton.joints.size(); ++j)
      nameless.skeleton.joints[j].name = "joint " + std::to_string(j);
    fitter.fit(nameless, segmentation, model, {}, {});
    broken.push_back("a fit without a single landmark or joint of the model's is not refused");
  } catch (const std::exception &) { // of whatever kind: Python has its own
  }
  try {
    Segmentation shorter = segmentation;
    shorter.clothness.conservativeResize(segmentation.clothness.size() - 1);
    fitter.fit(actor, shorter, model, landmarks, {});
    broken.push_back("a segmentation of another mesh is not refused");
  } catch (const std::exception &) {
  }
  return broken;
}

} // namespace doublet::testing
