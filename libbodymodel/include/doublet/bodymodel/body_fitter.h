#pragma once
// The body under the clothes (Sect. 5): statistical model, its fit, collision proxies.

#include "doublet/core/context.h"
#include "doublet/core/stage_values.h"

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace doublet {

/// vertices = mean + components * s, s ~ N(0, I). An interface, so that other models can stand in.
class BodyModel {
public:
  virtual ~BodyModel() = default;
  virtual int vertex_count() const = 0;
  virtual int component_count() const = 0;
  virtual const Faces &faces() const = 0;
  virtual Vertices vertices(const Eigen::VectorXd &coefficients) const = 0;  ///< (B, 3) m
  virtual Vertices component(int k) const = 0;                                ///< (B, 3) m per standard deviation
  virtual const std::map<std::string, int> &landmarks() const = 0;            ///< name -> vertex
  virtual std::string name() const = 0;                                       ///< name and hash of the file
  static std::shared_ptr<const BodyModel> read(const std::filesystem::path &path);
};

struct BodyFitOptions {
  int iterations = 20;
  void validate() const;
};

class BodyFitter {
public:
  virtual ~BodyFitter() = default;
  /// actor: surface in the scan pose; clothness: delta = 0 is skin, delta > 0 hides it; landmarks: name -> point on the surface (m).
  virtual BodyFit fit(const RiggedMesh &actor, const Clothness &clothness, const BodyModel &model,
                      const std::map<std::string, Eigen::Vector3d> &landmarks, const Context &context) const = 0;
  static std::unique_ptr<BodyFitter> create(const BodyFitOptions &options = {});
};

struct ProxyOptions {
  double clearance = 0.0;  ///< m, the capsules stand this much inside the body on average
};
/// Tapered capsules for the bones where cloth can touch.
std::vector<TaperedCapsule> fit_proxies(const BodyFit &fit, const RiggedMesh &actor, const Clothness &clothness,
                                        const ProxyOptions &options = {});

}  // namespace doublet
