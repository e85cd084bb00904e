#include "doublet/capture/limb_search.h"

#include "doublet/capture/pose_optimizer.h"
#include "doublet/core/rasterizer.h"
#include "small_view.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

namespace doublet {
namespace {

std::vector<std::vector<int>> free_branches(const Skeleton &skeleton) {
  const int joints = skeleton.joint_count();
  std::vector<bool> free(joints);
  std::vector<std::vector<int>> branches(joints);
  for (int j = joints - 1; j >= 0; --j) { // parents come first
    free[j] = skeleton.joints[j].dof_count > 0 || !branches[j].empty();
    if (free[j] && skeleton.joints[j].parent >= 0)
      branches[skeleton.joints[j].parent].insert(branches[skeleton.joints[j].parent].begin(), j);
  }
  return branches;
}

/// Does the joint, or what follows it before the next fork, have a degree of freedom?
bool has_freedom(const Skeleton &skeleton, const std::vector<std::vector<int>> &branches, int joint) {
  while (skeleton.joints[joint].dof_count == 0 && branches[joint].size() == 1)
    joint = branches[joint][0];
  return skeleton.joints[joint].dof_count > 0;
}

/// (J) the limb each joint belongs to, -1 for the root and what moves rigidly with it.
std::vector<int> limb_of_joint(const Skeleton &skeleton, const std::vector<Limb> &limbs) {
  std::vector<int> limb(skeleton.joint_count(), -1);
  for (size_t l = 0; l < limbs.size(); ++l)
    for (int j : limbs[l].joints)
      limb[j] = static_cast<int>(l);
  return limb;
}

/// (F) the limb that moves most of each face; -1 = none.
std::vector<int> limb_of_face(const RiggedMesh &actor, const std::vector<Limb> &limbs) {
  const std::vector<int> of_joint = limb_of_joint(actor.skeleton, limbs);
  MatrixRM shares = MatrixRM::Zero(actor.mesh.vertices.rows(), static_cast<Eigen::Index>(limbs.size()) + 1); // the last: no limb
  for (int j = 0; j < actor.skeleton.joint_count(); ++j)
    shares.col(of_joint[j] < 0 ? static_cast<int>(limbs.size()) : of_joint[j]) += actor.weights.col(j);
  std::vector<int> of_face(actor.mesh.faces.rows());
  for (int f = 0; f < actor.mesh.faces.rows(); ++f) {
    Eigen::Index largest;
    (shares.row(actor.mesh.faces(f, 0)) + shares.row(actor.mesh.faces(f, 1)) + shares.row(actor.mesh.faces(f, 2)))
        .maxCoeff(&largest);
    of_face[f] = largest == static_cast<Eigen::Index>(limbs.size()) ? -1 : static_cast<int>(largest);
  }
  return of_face;
}

struct SeenBone {
  int limb;
  Eigen::Vector2d from, to; // pixels
};

std::vector<SeenBone> bones_in_view(const Skeleton &skeleton, const Vertices &joints, const std::vector<int> &limb_of_joint,
                                    const Camera &camera) {
  std::vector<SeenBone> bones;
  for (int j = 0; j < skeleton.joint_count(); ++j) {
    const int parent = skeleton.joints[j].parent;
    if (parent < 0 || limb_of_joint[parent] < 0 || camera.depth(joints.row(j)) <= 0 || camera.depth(joints.row(parent)) <= 0)
      continue;
    bones.push_back({limb_of_joint[parent], camera.project(joints.row(parent)), camera.project(joints.row(j))});
  }
  return bones;
}

double squared_distance(const SeenBone &bone, const Eigen::Vector2d &p) {
  const Eigen::Vector2d way = bone.to - bone.from;
  const double along = way.squaredNorm() > 0 ? std::clamp((p - bone.from).dot(way) / way.squaredNorm(), 0.0, 1.0) : 0;
  return (bone.from + along * way - p).squaredNorm();
}

/// Sums over one view, or over all.
struct LimbSums {
  Eigen::VectorXd error, pixels; // (limbs) m times pixels; pixels
  explicit LimbSums(size_t limbs) : error(Eigen::VectorXd::Zero(limbs)), pixels(error) {}
};

/// The disagreement of one view's rendering and mask, limb by limb.
class ViewCheck {
public:
  ViewCheck(const SmallView &view, const FaceBuffer &rendered, const std::vector<int> &limb_of_face,
            const Eigen::VectorXd &face_reliability, double reach)
      : view_(view), rendered_(rendered), limb_of_face_(limb_of_face), reliability_(face_reliability), reach_(reach),
        mask_(rendered.height, rendered.width, CV_8UC1, const_cast<std::uint8_t *>(view.mask.data.data())),
        silhouette_(silhouette(rendered)), covered_(rendered.height, rendered.width, CV_8UC1, silhouette_.data.data()) {}

  /// Rendered pixels outside the mask.
  void add_outside(LimbSums &sums) const {
    cv::Mat distance;
    cv::distanceTransform(~mask_, distance, cv::DIST_L2, 5);
    for (int y = 0; y < rendered_.height; ++y)
      for (int x = 0; x < rendered_.width; ++x) {
        const int face = rendered_.face_at(x, y), limb = face < 0 ? -1 : limb_of_face_[face];
        if (limb < 0)
          continue;
        sums.pixels[limb] += reliability_[face];
        sums.error[limb] += reliability_[face] * metres(distance.at<float>(y, x), x, y);
      }
  }

  /// Mask pixels that the rendering does not explain, a connected piece at a time.
  void add_uncovered(const std::vector<SeenBone> &bones, LimbSums &sums) const {
    if (bones.empty() || cv::countNonZero(covered_) == 0)
      return;
    cv::Mat distance, nearest, pieces;
    cv::distanceTransform(~covered_, distance, nearest, cv::DIST_L2, 5, cv::DIST_LABEL_PIXEL);
    std::vector<cv::Point> pixel_of_label(1);
    for (int y = 0; y < covered_.rows; ++y)
      for (int x = 0; x < covered_.cols; ++x)
        if (covered_.at<std::uint8_t>(y, x)) {
          pixel_of_label.resize(std::max<size_t>(pixel_of_label.size(), nearest.at<int>(y, x) + 1));
          pixel_of_label[nearest.at<int>(y, x)] = {x, y};
        }
    const cv::Mat unexplained = mask_ & (distance > kSeam);
    const int count = cv::connectedComponents(unexplained, pieces, 8, CV_32S);
    std::vector<double> weight(count, 0), least(count, 1e30);
    std::vector<int> limb(count, -1);
    for (int y = 0; y < covered_.rows; ++y)
      for (int x = 0; x < covered_.cols; ++x) {
        const int piece = pieces.at<int>(y, x);
        if (piece == 0)
          continue;
        const cv::Point &edge = pixel_of_label[nearest.at<int>(y, x)];
        weight[piece] += reliability_[rendered_.face_at(edge.x, edge.y)] * metres(distance.at<float>(y, x), edge.x, edge.y);
        for (const SeenBone &bone : bones)
          if (const double d = squared_distance(bone, {x, y}); d < least[piece]) {
            least[piece] = d;
            limb[piece] = bone.limb;
          }
      }
    for (int piece = 1; piece < count; ++piece)
      sums.error[limb[piece]] += weight[piece];
  }

private:
  static constexpr double kSeam = 1.5; // px; thinner slivers along the outline are no pieces

  /// A distance in the image, metres at the depth of the rendered pixel, up to the reach.
  double metres(float pixels, int x, int y) const {
    return std::min<double>(pixels * rendered_.depth_at(x, y) / view_.camera.K(0, 0), reach_);
  }

  const SmallView &view_;
  const FaceBuffer &rendered_;
  const std::vector<int> &limb_of_face_;
  const Eigen::VectorXd &reliability_;
  double reach_;
  cv::Mat mask_;
  Image silhouette_;
  cv::Mat covered_;
};

Eigen::VectorXd mean_over_corners(const Eigen::VectorXd &values, const Faces &faces) {
  Eigen::VectorXd mean(faces.rows());
  for (int f = 0; f < faces.rows(); ++f)
    mean[f] = (values[faces(f, 0)] + values[faces(f, 1)] + values[faces(f, 2)]) / 3;
  return mean;
}

/// m, mean over the points that keypoints show of how far beyond their tolerance they are, each at most `most`; 0 if there are
/// none.
double distance_to(const std::vector<SeenPoint> &points, const Skeleton &skeleton, const Eigen::VectorXd &dofs, double most) {
  if (points.empty())
    return 0;
  const Transforms world_from_rest = forward_kinematics(skeleton, dofs);
  double sum = 0;
  for (const SeenPoint &point : points)
    sum += std::min(most, point.beyond(world_from_rest.at(point.joint) * point.rest));
  return sum / static_cast<double>(points.size());
}

/// Those of the points that move with a limb.
std::vector<SeenPoint> points_of(const std::vector<SeenPoint> &points, const Limb &limb) {
  std::vector<SeenPoint> own;
  for (const SeenPoint &point : points)
    if (std::find(limb.joints.begin(), limb.joints.end(), point.joint) != limb.joints.end())
      own.push_back(point);
  return own;
}

void require_complete(const LimbProblem &problem, const Eigen::VectorXd &dofs) {
  if (!problem.actor || !problem.rig || !problem.masks || problem.masks->size() != problem.rig->size())
    throw std::invalid_argument("limb search: the problem needs an actor, a rig and one mask per camera");
  if (dofs.size() != problem.actor->skeleton.dof_count())
    throw std::invalid_argument("limb search: expected a pose of " + std::to_string(problem.actor->skeleton.dof_count()) +
                                " degrees of freedom, got " + std::to_string(dofs.size()));
}

void require_limbs(const std::vector<Limb> &limbs, const Skeleton &skeleton) {
  const auto below = [](const std::vector<int> &indices, int count) {
    return std::all_of(indices.begin(), indices.end(), [&](int i) { return i >= 0 && i < count; });
  };
  for (const Limb &limb : limbs)
    if (!below(limb.joints, skeleton.joint_count()) || !below(limb.dofs, skeleton.dof_count()))
      throw std::invalid_argument("limb search: expected limbs of the actor's skeleton, found '" + limb.name +
                                  "' of another one");
}

/// The part of an actor that some degrees of freedom move, as an actor of its own.
RiggedMesh moved_part(const RiggedMesh &actor, const std::vector<int> &dofs, std::vector<std::uint8_t> &rest_of_faces,
                      Vertices &offset) {
  constexpr double kMoved = 0.01; // influence below which a vertex stays
  const MatrixRM influence = dof_influence(actor);
  std::vector<bool> moved(actor.mesh.vertices.rows(), false);
  for (int i = 0; i < actor.mesh.vertices.rows(); ++i)
    for (int d : dofs)
      moved[i] = moved[i] || influence(i, d) > kMoved;
  std::vector<int> place(actor.mesh.vertices.rows(), -1), kept;
  std::vector<Eigen::Vector3i> faces;
  rest_of_faces = actor.face_valid; // becomes: what to draw of the part that stays
  for (int f = 0; f < actor.mesh.faces.rows(); ++f) {
    const Eigen::Vector3i corners = actor.mesh.faces.row(f);
    if (!rest_of_faces[f] || !(moved[corners[0]] || moved[corners[1]] || moved[corners[2]]))
      continue;
    rest_of_faces[f] = 0;
    Eigen::Vector3i own;
    for (int c = 0; c < 3; ++c) {
      int &where = place[corners[c]];
      if (where < 0) {
        where = static_cast<int>(kept.size());
        kept.push_back(corners[c]);
      }
      own[c] = where;
    }
    faces.push_back(own);
  }
  RiggedMesh part;
  part.skeleton = actor.skeleton;
  part.mesh.vertices.resize(kept.size(), 3);
  part.weights.resize(kept.size(), actor.weights.cols());
  Vertices part_offset(offset.rows() > 0 ? kept.size() : 0, 3);
  for (size_t i = 0; i < kept.size(); ++i) {
    part.mesh.vertices.row(i) = actor.mesh.vertices.row(kept[i]);
    part.weights.row(i) = actor.weights.row(kept[i]);
    if (offset.rows() > 0)
      part_offset.row(i) = offset.row(kept[i]);
  }
  offset = part_offset;
  part.mesh.faces.resize(faces.size(), 3);
  for (size_t f = 0; f < faces.size(); ++f)
    part.mesh.faces.row(f) = faces[f];
  return part;
}

/// The overlap energy as a function of one limb's angles: what the limb does not move is drawn once.
class LimbEnergy {
public:
  LimbEnergy(const LimbProblem &problem, const std::vector<SmallView> &views, const Eigen::VectorXd &dofs, const Limb &limb,
             const LimbSearchOptions &options, const Context &context)
      : problem_(problem), views_(views), dofs_(dofs), limb_(limb), options_(options), context_(context), offset_(problem.offset),
        points_(points_of(problem.points, limb)) {
    std::vector<std::uint8_t> stays;
    part_ = moved_part(*problem.actor, limb.dofs, stays, offset_);
    const Vertices surface = pose_surface(*problem.actor, dofs, problem.offset).vertices;
    const Vertices moved = pose_surface(part_, dofs, offset_).vertices;
    rest_.resize(views.size());
    std::vector<int> pixels(views.size(), 0);
    parallel_for(context, static_cast<int>(views.size()), [&](int v) {
      if (views[v].mask.empty())
        return;
      rest_[v] = silhouette(rasterize(surface, problem.actor->mesh.faces, views[v].camera, stays));
      const FaceBuffer limb_alone = rasterize(moved, part_.mesh.faces, views[v].camera);
      pixels[v] = static_cast<int>(std::count_if(limb_alone.face.begin(), limb_alone.face.end(), [](int f) { return f >= 0; }));
    });
    for (int p : pixels)
      area_ += p;
  }

  /// For samples (n, limb dofs): pixels that are wrong because of the limb, against its area, plus the smoothness prior and how
  /// far its joints are from where keypoints show them. Constant terms are left out.
  Eigen::VectorXd operator()(const Eigen::MatrixXd &samples) const {
    Eigen::VectorXd energies(samples.rows());
    parallel_for(context_, static_cast<int>(samples.rows()), [&](int i) { energies[i] = energy(samples.row(i)); });
    context_.throw_if_cancelled();
    return energies;
  }

private:
  double energy(const Eigen::VectorXd &sample) const {
    Eigen::VectorXd dofs = dofs_;
    double prior = 0;
    for (size_t k = 0; k < limb_.dofs.size(); ++k) {
      dofs[limb_.dofs[k]] = sample[k];
      prior += std::pow((sample[k] - problem_.predicted[limb_.dofs[k]]) / options_.deviation, 2);
    }
    const Vertices surface = pose_surface(part_, dofs, offset_).vertices;
    int wrong = 0;
    for (size_t v = 0; v < views_.size(); ++v)
      if (!views_[v].mask.empty()) {
        const FaceBuffer drawn = rasterize(surface, part_.mesh.faces, views_[v].camera);
        for (size_t p = 0; p < drawn.face.size(); ++p)
          if (drawn.face[p] >= 0 && !rest_[v].data[p]) // explains a pixel, or is wrong there
            wrong += views_[v].mask.data[p] ? -1 : 1;
      }
    const double off = distance_to(points_, problem_.actor->skeleton, dofs, options_.max_error) / options_.max_error;
    return wrong / std::max(1.0, area_) + options_.smoothness * prior + options_.keypoint_weight * off;
  }

  const LimbProblem &problem_;
  const std::vector<SmallView> &views_;
  const Eigen::VectorXd &dofs_;
  const Limb &limb_;
  const LimbSearchOptions &options_;
  const Context &context_;
  Vertices offset_;
  std::vector<SeenPoint> points_; // of this limb
  RiggedMesh part_;
  std::vector<Image> rest_; // silhouettes of what stays
  double area_ = 0;
};

class AnnealedLimbs : public LimbSearch {
public:
  explicit AnnealedLimbs(const LimbSearchOptions &options) : options_(options) {}

  Eigen::VectorXd search(const LimbProblem &problem, const Eigen::VectorXd &dofs, const std::vector<Limb> &lost,
                         const Context &context) override {
    require_complete(problem, dofs);
    const Skeleton &skeleton = problem.actor->skeleton;
    require_limbs(lost, skeleton);
    if (problem.predicted.size() != dofs.size())
      throw std::invalid_argument("limb search: expected a prediction of " + std::to_string(dofs.size()) +
                                  " degrees of freedom, got " + std::to_string(problem.predicted.size()));
    const std::vector<SmallView> views = small_views(*problem.rig, *problem.masks, options_.raster_size);
    Eigen::VectorXd found = dofs;
    for (const Limb &limb : lost) {
      const LimbEnergy energy(problem, views, found, limb, options_, context);
      const Eigen::VectorXd deviation = Eigen::VectorXd::Constant(limb.dofs.size(), options_.deviation);
      const ParticleAnnealingResult result = anneal(energy, problem.predicted(limb.dofs), deviation, skeleton.lower(limb.dofs),
                                                    skeleton.upper(limb.dofs), options_.annealing);
      found(limb.dofs) = result.best;
    }
    return found;
  }

private:
  LimbSearchOptions options_;
};

} // namespace

std::vector<Limb> find_limbs(const Skeleton &skeleton) {
  const std::vector<std::vector<int>> branches = free_branches(skeleton);
  std::vector<Limb> limbs;
  std::vector<int> limb(skeleton.joint_count(), -1);
  for (int j = 0; j < skeleton.joint_count(); ++j) {
    const Joint &joint = skeleton.joints[j];
    if (joint.parent < 0)
      continue;
    const std::vector<int> &beside = branches[joint.parent];
    const bool moves = std::find(beside.begin(), beside.end(), j) != beside.end();
    // A fixed joint that forks (a pelvis below a root) has nothing to search: it goes with what is before it.
    const bool begins =
        moves && has_freedom(skeleton, branches, j) && (beside.size() > 1 || skeleton.joints[joint.parent].parent < 0);
    if (begins) {
      limb[j] = static_cast<int>(limbs.size());
      limbs.push_back({joint.name, {}, {}});
    } else {
      limb[j] = limb[joint.parent];
    }
    if (limb[j] < 0)
      continue;
    limbs[limb[j]].joints.push_back(j);
    for (int k = 0; k < joint.dof_count; ++k)
      limbs[limb[j]].dofs.push_back(joint.first_dof + k);
  }
  return limbs;
}

Eigen::VectorXd limb_errors(const LimbProblem &problem, const Eigen::VectorXd &dofs, const std::vector<Limb> &limbs,
                            const LimbSearchOptions &options, const Context &context) {
  require_complete(problem, dofs);
  const RiggedMesh &actor = *problem.actor;
  require_limbs(limbs, actor.skeleton);
  if (problem.reliability.size() != actor.mesh.vertices.rows())
    throw std::invalid_argument("limb_errors: expected a reliability for each of " + std::to_string(actor.mesh.vertices.rows()) +
                                " vertices, got " + std::to_string(problem.reliability.size()));
  const std::vector<SmallView> views = small_views(*problem.rig, *problem.masks, options.raster_size);
  const Vertices surface = pose_surface(actor, dofs, problem.offset).vertices;
  const Vertices joints = joint_positions(actor.skeleton, forward_kinematics(actor.skeleton, dofs));
  const std::vector<int> of_face = limb_of_face(actor, limbs), of_joint = limb_of_joint(actor.skeleton, limbs);
  const Eigen::VectorXd reliability = mean_over_corners(problem.reliability, actor.mesh.faces);
  std::vector<LimbSums> parts(views.size(), LimbSums(limbs.size()));
  parallel_for(context, static_cast<int>(views.size()), [&](int v) {
    if (views[v].mask.empty())
      return;
    const FaceBuffer rendered = rasterize(surface, actor.mesh.faces, views[v].camera, actor.face_valid);
    const ViewCheck check(views[v], rendered, of_face, reliability, options.max_error);
    check.add_outside(parts[v]);
    check.add_uncovered(bones_in_view(actor.skeleton, joints, of_joint, views[v].camera), parts[v]);
  });
  LimbSums sum(limbs.size());
  for (const LimbSums &part : parts) {
    sum.error += part.error;
    sum.pixels += part.pixels;
  }
  return sum.error.cwiseQuotient(sum.pixels.cwiseMax(1));
}

double overlap_energy(const LimbProblem &problem, const Eigen::VectorXd &dofs, const LimbSearchOptions &options,
                      const Context &context) {
  require_complete(problem, dofs);
  const std::vector<SmallView> views = small_views(*problem.rig, *problem.masks, options.raster_size);
  const Vertices surface = pose_surface(*problem.actor, dofs, problem.offset).vertices;
  std::vector<double> wrong(views.size(), 0), inside(views.size(), 0);
  parallel_for(context, static_cast<int>(views.size()), [&](int v) {
    if (views[v].mask.empty())
      return;
    const FaceBuffer rendered = rasterize(surface, problem.actor->mesh.faces, views[v].camera, problem.actor->face_valid);
    for (size_t p = 0; p < rendered.face.size(); ++p) {
      wrong[v] += (rendered.face[p] >= 0) != (views[v].mask.data[p] > 0);
      inside[v] += views[v].mask.data[p] > 0;
    }
  });
  double sum = 0, count = 0;
  for (size_t v = 0; v < views.size(); ++v)
    if (inside[v] > 0) {
      sum += wrong[v] / inside[v];
      count += 1;
    }
  const double off = distance_to(problem.points, problem.actor->skeleton, dofs, options.max_error) / options.max_error;
  return (count > 0 ? sum / count : 0) + options.keypoint_weight * off;
}

std::unique_ptr<LimbSearch> LimbSearch::create(const LimbSearchOptions &options) {
  options.validate();
  return std::make_unique<AnnealedLimbs>(options);
}

} // namespace doublet
