// The .npz files between stages, docs/formats.md.

#include "doublet/core/error.h"
#include "doublet/files/files.h"
#include "doublet/files/npz.h"
#include "doublet/options/options.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>

namespace doublet {

namespace {

template <class Derived> std::vector<double> flat(const Eigen::MatrixBase<Derived> &m) {
  std::vector<double> out(m.size());
  Eigen::Map<MatrixRM>(out.data(), m.rows(), m.cols()) = m;
  return out;
}

template <class T> std::vector<double> flat(const std::vector<T> &parts) {
  std::vector<double> out;
  for (const T &part : parts) {
    const std::vector<double> one = flat(part);
    out.insert(out.end(), one.begin(), one.end());
  }
  return out;
}

void require(bool right, const std::string &message) {
  if (!right)
    throw std::invalid_argument(message);
}

void set_faces(Npz &npz, const Faces &faces) {
  npz.set_i4("faces", {faces.rows(), 3}, {faces.data(), faces.data() + faces.size()});
}

Mesh read_mesh(const Npz &npz) {
  npz.require_shape("vertices", {-1, 3});
  npz.require_shape("faces", {-1, 3});
  Mesh mesh;
  mesh.vertices = npz.matrix("vertices");
  const std::vector<int> corners = npz.integers("faces");
  mesh.faces = Eigen::Map<const Faces>(corners.data(), corners.size() / 3, 3);
  require_usable(mesh, npz.source);
  return mesh;
}

/// (N, rows, 3) -> N matrices.
std::vector<Vertices> read_frames(const Npz &npz, const std::string &name, Eigen::Index rows) {
  npz.require_shape(name, {-1, rows, 3});
  const std::vector<double> all = npz.values(name);
  std::vector<Vertices> out(npz.shape(name)[0]);
  for (std::size_t t = 0; t < out.size(); ++t)
    out[t] = Eigen::Map<const Vertices>(all.data() + t * rows * 3, rows, 3);
  return out;
}

/// Files hold floats: rows are brought back to a sum of exactly one.
MatrixRM read_weights(const Npz &npz, Eigen::Index vertices, Eigen::Index joints) {
  npz.require_shape("weights", {vertices, joints});
  MatrixRM weights = npz.matrix("weights");
  for (Eigen::Index v = 0; v < vertices; ++v) {
    const double sum = weights.row(v).sum();
    if (!(std::abs(sum - 1) < 1e-3) || weights.row(v).minCoeff() < 0)
      throw Error(npz.source + ": array 'weights': expected rows of weights >= 0 with sum one, found row " + std::to_string(v) +
                  " with sum " + options::to_text(sum, 4) + " and minimum " + options::to_text(weights.row(v).minCoeff(), 4));
    weights.row(v) /= sum;
  }
  return weights;
}

Skeleton read_skeleton(const Npz &npz) {
  const std::vector<std::string> names = npz.text("joint_names"), dof_names = npz.text("dof_names");
  const auto count = static_cast<std::int64_t>(names.size());
  npz.require_shape("joint_parents", {count});
  npz.require_shape("joint_rest", {count, 3});
  const std::vector<int> parents = npz.integers("joint_parents");
  const MatrixRM rest = npz.matrix("joint_rest");
  std::map<std::string, int> dof;
  for (const std::string &name : dof_names)
    ++dof[name.substr(0, name.rfind('.'))];
  std::vector<JointAnnotation> marks;
  for (int j = 0; j < count; ++j) {
    if (parents[j] >= j || parents[j] < -1)
      throw Error(npz.source + ": array 'joint_parents': expected parents before their children, found " +
                  std::to_string(parents[j]) + " at joint " + std::to_string(j));
    marks.push_back({names[j], parents[j] < 0 ? "" : names[parents[j]], rest.row(j), dof[names[j]]});
  }
  Skeleton skeleton;
  try {
    skeleton = make_skeleton(marks);
  } catch (const Error &error) {
    throw Error(npz.source + ": " + error.what());
  }
  if (skeleton.dof_names != dof_names)
    throw Error(npz.source + ": array 'dof_names': expected the " + std::to_string(skeleton.dof_count()) +
                " degrees of freedom of the joints in their order, found " + std::to_string(dof_names.size()) + " others");
  return skeleton;
}

Eigen::VectorXd read_vector(const Npz &npz, const std::string &name, std::int64_t size) {
  npz.require_shape(name, {size});
  return npz.matrix(name).col(0);
}

/// (count) values in [0, 1]; -1 = of any length.
Eigen::VectorXd read_shares(const Npz &npz, const std::string &name, std::int64_t count) {
  const Eigen::VectorXd values = read_vector(npz, name, count);
  if (!(values.array() >= 0 && values.array() <= 1).all())
    throw Error(npz.source + ": array '" + name + "': expected values in [0, 1], found others");
  return values;
}

/// Lists of different length, one behind the other, with the start of each.
struct FlatLists {
  std::vector<double> values;
  std::vector<int> offsets = {0};
  int width;
  explicit FlatLists(int w) : width(w) {}
  void close_list() { offsets.push_back(static_cast<int>(values.size()) / width); }
};

void set_lists(Npz &npz, const std::string &name, const FlatLists &lists) {
  npz.set_f4(name + "_points", {lists.offsets.back(), lists.width}, lists.values);
  npz.set_i4(name + "_offsets", {static_cast<std::int64_t>(lists.offsets.size())}, lists.offsets);
}

FlatLists read_lists(const Npz &npz, const std::string &name, int width, std::size_t count) {
  FlatLists lists(width);
  npz.require_shape(name + "_points", {-1, width});
  npz.require_shape(name + "_offsets", {static_cast<std::int64_t>(count) + 1});
  lists.values = npz.values(name + "_points");
  lists.offsets = npz.integers(name + "_offsets");
  const bool whole = lists.offsets.front() == 0 && lists.offsets.back() == npz.shape(name + "_points")[0];
  if (!whole || !std::is_sorted(lists.offsets.begin(), lists.offsets.end()))
    throw Error(npz.source + ": array '" + name + "_offsets': expected rising offsets from 0 to the number of points");
  return lists;
}

void set_cameras(Npz &npz, const CameraRig &cameras) {
  std::vector<std::string> names;
  std::vector<double> K, distortion, R, t;
  std::vector<int> size;
  const auto add = [](std::vector<double> &to, const std::vector<double> &from) {
    to.insert(to.end(), from.begin(), from.end());
  };
  for (const Camera &c : cameras) {
    names.push_back(c.name);
    add(K, flat(c.K));
    add(distortion, flat(c.distortion));
    add(R, flat(c.R));
    add(t, flat(c.t));
    size.insert(size.end(), {c.width, c.height});
  }
  const auto n = static_cast<std::int64_t>(cameras.size());
  npz.set_text("camera_names", names);
  npz.set_f8("camera_K", {n, 3, 3}, K);
  npz.set_f8("camera_distortion", {n, 5}, distortion);
  npz.set_f8("camera_R", {n, 3, 3}, R);
  npz.set_f8("camera_t", {n, 3}, t);
  npz.set_i4("camera_size", {n, 2}, size);
}

CameraRig read_cameras(const Npz &npz) {
  const std::vector<std::string> names = npz.text("camera_names");
  const auto n = static_cast<std::int64_t>(names.size());
  npz.require_shape("camera_distortion", {n, 5});
  npz.require_shape("camera_t", {n, 3});
  npz.require_shape("camera_size", {n, 2});
  const std::vector<Vertices> K = read_frames(npz, "camera_K", 3), R = read_frames(npz, "camera_R", 3);
  if (K.size() != names.size() || R.size() != names.size())
    throw Error(npz.source + ": expected camera_K and camera_R for " + std::to_string(n) + " cameras, found " +
                std::to_string(K.size()) + " and " + std::to_string(R.size()));
  const MatrixRM distortion = npz.matrix("camera_distortion"), t = npz.matrix("camera_t");
  const std::vector<int> size = npz.integers("camera_size");
  CameraRig cameras(names.size());
  for (std::size_t c = 0; c < names.size(); ++c) {
    cameras[c] = {names[c], K[c], distortion.row(c), R[c], t.row(c), size[2 * c], size[2 * c + 1]};
    validate_camera(cameras[c], npz.source);
  }
  return cameras;
}

} // namespace

void write_actor(const Path &path, const RiggedMesh &actor) {
  const Skeleton &skeleton = actor.skeleton;
  const auto V = actor.mesh.vertices.rows();
  require_actor(actor, "write_actor");
  std::vector<std::string> names;
  std::vector<int> parents;
  std::vector<double> rest;
  for (const Joint &j : skeleton.joints) {
    names.push_back(j.name);
    parents.push_back(j.parent);
    rest.insert(rest.end(), {j.rest.x(), j.rest.y(), j.rest.z()});
  }
  Npz npz;
  npz.set_f4("vertices", {V, 3}, flat(actor.mesh.vertices));
  set_faces(npz, actor.mesh.faces);
  npz.set_b1("face_valid", actor.face_valid);
  npz.set_f4("weights", {V, skeleton.joint_count()}, flat(actor.weights));
  npz.set_text("joint_names", names);
  npz.set_i4("joint_parents", {skeleton.joint_count()}, parents);
  npz.set_f4("joint_rest", {skeleton.joint_count(), 3}, rest);
  npz.set_text("dof_names", skeleton.dof_names);
  npz.write(path, kFileFormat);
}

RiggedMesh read_actor(const Path &path) {
  const Npz npz = Npz::read(path, {}, kFileFormat);
  RiggedMesh actor;
  actor.mesh = read_mesh(npz);
  npz.require_shape("face_valid", {actor.mesh.faces.rows()});
  const std::vector<int> valid = npz.integers("face_valid");
  actor.face_valid.assign(valid.begin(), valid.end());
  actor.skeleton = read_skeleton(npz);
  actor.weights = read_weights(npz, actor.mesh.vertices.rows(), actor.skeleton.joint_count());
  return actor;
}

void write_performance(const Path &path, const ReferencePerformance &performance) {
  const auto T = static_cast<std::int64_t>(performance.surface.frames.size());
  require(T > 0 && performance.dofs.rows() == T && static_cast<std::int64_t>(performance.joints.size()) == T &&
              static_cast<std::int64_t>(performance.frames.size()) == T,
          "write_performance: expected surfaces, poses, joints and frame numbers of the same frames, found " + std::to_string(T) +
              ", " + std::to_string(performance.dofs.rows()) + ", " + std::to_string(performance.joints.size()) + " and " +
              std::to_string(performance.frames.size()));
  require_frames(performance.surface.frames, performance.surface.frames[0].rows(), "write_performance: a frame");
  require_frames(performance.joints, performance.joints[0].rows(), "write_performance: a frame of the joints");
  if (!performance.dofs.allFinite())
    throw Error("write_performance: dofs: expected finite numbers, found NaN or infinity");
  Npz npz;
  npz.set_f4("vertices", {T, performance.surface.frames[0].rows(), 3}, flat(performance.surface.frames));
  npz.set_f4("dofs", {T, performance.dofs.cols()}, flat(performance.dofs));
  npz.set_f4("joints", {T, performance.joints[0].rows(), 3}, flat(performance.joints));
  npz.set_i4("frames", {T}, performance.frames);
  npz.write(path, kFileFormat);
}

ReferencePerformance read_performance(const Path &path, const RiggedMesh &actor) {
  const Npz npz = Npz::read(path, {}, kFileFormat);
  ReferencePerformance out;
  out.surface.faces = actor.mesh.faces;
  out.surface.frames = read_frames(npz, "vertices", actor.mesh.vertices.rows());
  const auto T = static_cast<std::int64_t>(out.surface.frames.size());
  npz.require_shape("dofs", {T, actor.skeleton.dof_count()});
  npz.require_shape("joints", {T, actor.skeleton.joint_count(), 3});
  npz.require_shape("frames", {T});
  out.dofs = npz.matrix("dofs");
  out.joints = read_frames(npz, "joints", actor.skeleton.joint_count());
  out.frames = npz.integers("frames");
  require_performance(out, actor, npz.source);
  return out;
}

void write_segmentation(const Path &path, const Segmentation &segmentation) {
  const auto V = segmentation.clothness.size();
  require_segmentation(segmentation, V, "write_segmentation");
  require(segmentation.sigma.size() == V, "write_segmentation: expected sigma of the length of clothness");
  Npz npz;
  npz.set_f4("sigma", {V}, flat(segmentation.sigma));
  npz.set_f4("clothness", {V}, flat(segmentation.clothness));
  npz.set_i4("region", {V}, {segmentation.region.data(), segmentation.region.data() + V});
  if (segmentation.probability.size() > 0)
    npz.set_f4("probability", {V}, flat(segmentation.probability));
  npz.write(path, kFileFormat);
}

Segmentation read_segmentation(const Path &path) {
  const Npz npz = Npz::read(path, {}, kFileFormat);
  Segmentation out;
  out.clothness = read_shares(npz, "clothness", -1);
  out.sigma = read_vector(npz, "sigma", out.clothness.size());
  npz.require_shape("region", {out.clothness.size()});
  const std::vector<int> region = npz.integers("region");
  out.region = Eigen::Map<const Eigen::VectorXi>(region.data(), region.size());
  for (const int r : region) {
    if (r < -1 || r >= out.clothness.size())
      throw Error(npz.source + ": array 'region': expected -1 or one of fewer regions than vertices, found " + std::to_string(r));
    out.region_count = std::max(out.region_count, r + 1);
  }
  if (npz.has("probability"))
    out.probability = read_shares(npz, "probability", out.clothness.size());
  return out;
}

void write_garment(const Path &path, const Garment &garment) {
  const auto G = garment.mesh.vertices.rows();
  require(garment.region.size() == G && garment.clothness.size() == G && garment.rest.rows() == G &&
              garment.actor_face.size() == G && garment.barycentric.rows() == G,
          "write_garment: expected region, clothness, rest, actor_face and barycentric for " + std::to_string(G) + " vertices");
  Npz npz;
  npz.set_f4("vertices", {G, 3}, flat(garment.mesh.vertices));
  set_faces(npz, garment.mesh.faces);
  npz.set_i4("region", {G}, {garment.region.data(), garment.region.data() + G});
  npz.set_f4("clothness", {G}, flat(garment.clothness));
  npz.set_f4("rest", {G, 3}, flat(garment.rest));
  if (!garment.widths.empty()) {
    std::vector<double> widths;
    for (const Vertices &width : garment.widths) {
      require(width.rows() == G,
              "write_garment: expected widths of " + std::to_string(G) + " vertices, found " + std::to_string(width.rows()));
      const auto values = flat(width);
      widths.insert(widths.end(), values.begin(), values.end());
    }
    npz.set_f4("widths", {static_cast<std::int64_t>(garment.widths.size()), G, 3}, widths);
  }
  npz.set_i4("actor_face", {G}, {garment.actor_face.data(), garment.actor_face.data() + G});
  npz.set_f4("barycentric", {G, 3}, flat(garment.barycentric));
  npz.set_b1("covers", garment.replaced_faces);
  if (garment.attachment.size() > 0)
    npz.set_f4("attachment", {garment.attachment.size()}, flat(garment.attachment));
  npz.write(path, kFileFormat);
}

Garment read_garment(const Path &path, const RiggedMesh &actor) {
  const Npz npz = Npz::read(path, {}, kFileFormat);
  npz.require_shape("vertices", {-1, 3});
  Garment out;
  const auto G = npz.shape("vertices")[0];
  const auto integers = [&](const std::string &name) {
    npz.require_shape(name, {G});
    const std::vector<int> values = npz.integers(name);
    return Eigen::VectorXi(Eigen::Map<const Eigen::VectorXi>(values.data(), G));
  };
  npz.require_shape("barycentric", {G, 3});
  npz.require_shape("rest", {G, 3});
  npz.require_shape("covers", {actor.mesh.faces.rows()});
  if (G > 0)
    out.mesh = read_mesh(npz);
  out.region = integers("region");
  out.actor_face = integers("actor_face");
  out.clothness = read_vector(npz, "clothness", G);
  out.rest = npz.matrix("rest");
  if (G > 0 && npz.has("widths")) { // of nothing there may be any number
    npz.require_shape("widths", {-1, G, 3});
    const std::vector<double> values = npz.values("widths");
    for (std::int64_t k = 0; k < npz.shape("widths")[0]; ++k)
      out.widths.push_back(Eigen::Map<const Vertices>(values.data() + 3 * k * G, G, 3));
  }
  out.barycentric = npz.matrix("barycentric");
  for (int covered : npz.integers("covers"))
    out.replaced_faces.push_back(covered ? 1 : 0);
  if (npz.has("attachment"))
    out.attachment = read_shares(npz, "attachment", actor.mesh.vertices.rows());
  out.region_count = G > 0 ? out.region.maxCoeff() + 1 : 0;
  if (G > 0)
    validate_garment(out, actor, npz.source);
  return out;
}

void write_body(const Path &path, const BodyFit &fit) {
  require_body(fit, "write_body");
  Npz npz;
  npz.set_f4("vertices", {fit.body.vertices.rows(), 3}, flat(fit.body.vertices));
  set_faces(npz, fit.body.faces);
  npz.set_f4("coefficients", {fit.coefficients.size()}, flat(fit.coefficients));
  npz.set_text("model", {fit.model});
  npz.set_f4("residual", {1}, {fit.residual});
  if (fit.deviation.size() > 0)
    npz.set_f4("deviation", {fit.deviation.size()}, flat(fit.deviation));
  npz.write(path, kFileFormat);
}

BodyFit read_body(const Path &path) {
  const Npz npz = Npz::read(path, {}, kFileFormat);
  BodyFit fit;
  fit.body = read_mesh(npz);
  fit.coefficients = read_vector(npz, "coefficients", -1);
  npz.require_shape("model", {1});
  fit.model = npz.text("model")[0];
  fit.residual = read_vector(npz, "residual", 1)[0];
  if (npz.has("deviation"))
    fit.deviation = read_vector(npz, "deviation", fit.body.vertices.rows());
  require_body(fit, npz.source);
  return fit;
}

void write_observations(const Path &path, const Observations &observations) {
  require(observations.views.size() == observations.frames.size(),
          "write_observations: expected views of " + std::to_string(observations.frames.size()) + " frames, found " +
              std::to_string(observations.views.size()));
  for (const Camera &camera : observations.cameras)
    validate_camera(camera, "write_observations");
  FlatLists contour(2), match(4);
  for (const std::vector<ViewObservation> &frame : observations.views) {
    require(frame.size() == observations.cameras.size(),
            "write_observations: expected one view for every camera, found " + std::to_string(frame.size()));
    for (const ViewObservation &view : frame) {
      for (const Eigen::Vector2f &p : view.contour)
        contour.values.insert(contour.values.end(), {p.x(), p.y()});
      for (const FeatureMatch &m : view.matches)
        match.values.insert(match.values.end(), {m.previous.x(), m.previous.y(), m.current.x(), m.current.y()});
      contour.close_list();
      match.close_list();
    }
  }
  Npz npz;
  set_cameras(npz, observations.cameras);
  npz.set_i4("frames", {static_cast<std::int64_t>(observations.frames.size())}, observations.frames);
  set_lists(npz, "contour", contour);
  set_lists(npz, "match", match);
  npz.write(path, kFileFormat);
}

Observations read_observations(const Path &path) {
  const Npz npz = Npz::read(path, {}, kFileFormat);
  Observations out;
  out.cameras = read_cameras(npz);
  out.frames = npz.integers("frames");
  const std::size_t C = out.cameras.size(), T = out.frames.size();
  const FlatLists contour = read_lists(npz, "contour", 2, T * C), match = read_lists(npz, "match", 4, T * C);
  out.views.assign(T, std::vector<ViewObservation>(C));
  for (std::size_t i = 0; i < T * C; ++i) {
    ViewObservation &view = out.views[i / C][i % C];
    for (int k = contour.offsets[i]; k < contour.offsets[i + 1]; ++k)
      view.contour.emplace_back(contour.values[2 * k], contour.values[2 * k + 1]);
    for (int k = match.offsets[i]; k < match.offsets[i + 1]; ++k)
      view.matches.push_back({Eigen::Vector2d(match.values[4 * k], match.values[4 * k + 1]).cast<float>(),
                              Eigen::Vector2d(match.values[4 * k + 2], match.values[4 * k + 3]).cast<float>()});
  }
  return out;
}

} // namespace doublet
