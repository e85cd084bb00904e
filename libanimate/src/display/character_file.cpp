#include "doublet/animate/character_file.h"

#include "doublet/animate/display_surface.h"
#include "doublet/core/error.h"
#include "doublet/options/json.h"
#include "glb_parts.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace doublet {
namespace {

using nlohmann::json;

constexpr const char *kExtension = "DOUBLET_character";
constexpr int kVersion = 3, kWithoutBody = 2; // 2: no body in M_high; 1: some of the cloth options

json vector_json(const Eigen::Vector3d &v) {
  return {v.x(), v.y(), v.z()};
}

Eigen::Vector3d json_vector(const json &j) {
  return {j.at(0).get<double>(), j.at(1).get<double>(), j.at(2).get<double>()};
}

/// TinyGLTF has its own tree of values.
tinygltf::Value to_value(const json &j) {
  if (j.is_object()) {
    tinygltf::Value::Object object;
    for (const auto &[key, value] : j.items())
      object[key] = to_value(value);
    return tinygltf::Value(object);
  }
  if (j.is_array()) {
    tinygltf::Value::Array array;
    for (const json &value : j)
      array.push_back(to_value(value));
    return tinygltf::Value(array);
  }
  if (j.is_boolean())
    return tinygltf::Value(j.get<bool>());
  if (j.is_number_integer())
    return tinygltf::Value(j.get<int>());
  if (j.is_number())
    return tinygltf::Value(j.get<double>());
  return tinygltf::Value(j.get<std::string>());
}

json skeleton_json(const Skeleton &skeleton) {
  json joints = json::array();
  for (const JointAnnotation &mark : joint_annotations(skeleton))
    joints.push_back(
        {{"name", mark.name}, {"parent", mark.parent}, {"dof", mark.dof.value()}, {"position", vector_json(mark.position)}});
  return joints;
}

Skeleton json_skeleton(const json &joints) {
  std::vector<JointAnnotation> marks;
  for (const json &j : joints) {
    JointAnnotation mark;
    mark.name = j.at("name").get<std::string>();
    mark.parent = j.at("parent").get<std::string>();
    mark.dof = j.at("dof").get<int>();
    mark.position = json_vector(j.at("position"));
    marks.push_back(mark);
  }
  return make_skeleton(marks);
}

json clothness_json(glb::Writer &writer, const Segmentation &segmentation) {
  std::vector<float> sigma, delta;
  std::vector<std::uint32_t> region;
  for (Eigen::Index v = 0; v < segmentation.clothness.size(); ++v) {
    const double s = v < segmentation.sigma.size() ? segmentation.sigma[v] : std::numeric_limits<double>::quiet_NaN();
    sigma.push_back(std::isfinite(s) ? static_cast<float>(s) : -1.0f); // glTF has no NaN
    delta.push_back(static_cast<float>(segmentation.clothness[v]));
    region.push_back(static_cast<std::uint32_t>(segmentation.region[v] + 1));
  }
  json out = {{"sigma", writer.floats(sigma, TINYGLTF_TYPE_SCALAR, glb::Use::Data)},
              {"clothness", writer.floats(delta, TINYGLTF_TYPE_SCALAR, glb::Use::Data)},
              {"region", writer.integers(region, glb::Use::Data)},
              {"regionCount", segmentation.region_count}};
  if (segmentation.rest.rows() > 0)
    out["rest"] = writer.vectors(segmentation.rest, glb::Use::Data);
  return out;
}

Segmentation json_clothness(const glb::Reader &reader, const json &j) {
  const std::vector<float> sigma = reader.floats(j.at("sigma").get<int>()), delta = reader.floats(j.at("clothness").get<int>());
  const std::vector<std::uint32_t> region = reader.integers(j.at("region").get<int>());
  if (sigma.size() != delta.size() || region.size() != delta.size())
    reader.fail("expected sigma, clothness and region of one length");
  Segmentation segmentation;
  segmentation.region_count = j.at("regionCount").get<int>();
  segmentation.sigma.resize(sigma.size());
  segmentation.clothness.resize(sigma.size());
  segmentation.region.resize(sigma.size());
  for (std::size_t v = 0; v < sigma.size(); ++v) {
    segmentation.sigma[v] = sigma[v] < 0 ? std::numeric_limits<double>::quiet_NaN() : sigma[v];
    segmentation.clothness[v] = delta[v];
    if (region[v] > static_cast<std::uint32_t>(std::max(segmentation.region_count, 0)))
      reader.fail("region " + std::to_string(region[v]) + " of " + std::to_string(segmentation.region_count));
    segmentation.region[v] = static_cast<int>(region[v]) - 1;
  }
  if (j.contains("rest")) { // of a garment with a mesh of its own
    segmentation.rest = reader.vectors(j.at("rest").get<int>());
    if (segmentation.rest.rows() != static_cast<Eigen::Index>(delta.size()))
      reader.fail("expected rest and segmentation of one length");
  }
  return segmentation;
}

json materials_json(const std::vector<pbd::Material> &materials) {
  json list = json::array();
  for (const pbd::Material &material : materials)
    list.push_back(options::to_json<json>(material));
  return list;
}

std::vector<pbd::Material> json_materials(const json &list) {
  std::vector<pbd::Material> materials(list.size());
  for (std::size_t i = 0; i < materials.size(); ++i)
    options::from_json(list[i], materials[i]);
  return materials;
}

/// Version 1, which had a list of its own and lay flat; what it left out was not known yet.
SolverSettings json_first_solver(const json &j) {
  SolverSettings solver;
  json cloth = {{"stiffness", j.value("stiffness", "sweeps")},     {"over_relaxation", 1.0},
                {"rest_curvature", j.value("restCurvature", 1.0)}, {"self_thickness", j.at("selfThickness")},
                {"self_collision", j.at("selfCollision")},         {"edge_collision", false}};
  for (const char *name : {"iterations", "substeps", "gravity", "restitution", "thickness"})
    cloth[name] = j.at(name);
  options::from_json<json>({{"dt", j.at("dt")}, {"cloth", cloth}}, solver);
  return solver;
}

SolverSettings json_solver(json j, int version) {
  SolverSettings solver;
  if (version == 1)
    return json_first_solver(j);
  j.at("cloth").emplace("over_relaxation", 1.0); // what files without them were fitted with
  j.at("cloth").emplace("edge_collision", false);
  options::from_json(j, solver);
  return solver;
}

json proxies_json(const std::vector<TaperedCapsule> &proxies) {
  json list = json::array();
  for (const TaperedCapsule &c : proxies)
    list.push_back({{"joint", c.joint}, {"p0", vector_json(c.p0)}, {"p1", vector_json(c.p1)}, {"r0", c.r0}, {"r1", c.r1}});
  return list;
}

std::vector<TaperedCapsule> json_proxies(const json &list) {
  std::vector<TaperedCapsule> proxies;
  for (const json &j : list)
    proxies.push_back({j.at("joint").get<int>(), json_vector(j.at("p0")), json_vector(j.at("p1")), j.at("r0").get<double>(),
                       j.at("r1").get<double>()});
  return proxies;
}

json mesh_json(glb::Writer &writer, const Mesh &mesh) {
  return {{"vertices", writer.vectors(mesh.vertices, glb::Use::Data)}, {"faces", writer.faces(mesh.faces, glb::Use::Data)}};
}

Mesh json_mesh(const glb::Reader &reader, const json &j) {
  return {reader.vectors(j.at("vertices").get<int>()), reader.faces(j.at("faces").get<int>())};
}

json extension_json(glb::Writer &writer, const Character &c, int texture_image) {
  json out;
  out["version"] = c.high_body.empty() ? kWithoutBody : kVersion;
  out["name"] = c.name;
  out["mesh"] = mesh_json(writer, c.actor.mesh);
  out["mesh"]["faceValid"] = writer.bytes(c.actor.face_valid);
  out["mesh"]["weights"] = writer.matrix(c.actor.weights);
  out["skeleton"] = skeleton_json(c.actor.skeleton);
  out["clothness"] = clothness_json(writer, c.segmentation);
  out["proxies"] = proxies_json(c.proxies);
  out["materials"] = materials_json(c.materials);
  out["solver"] = options::to_json<json>(c.solver);
  if (c.body.faces.rows() > 0) {
    out["body"] = mesh_json(writer, c.body);
    out["body"]["weights"] = writer.matrix(c.body_weights);
    out["body"]["shown"] = writer.bytes(c.body_shown);
    out["body"]["model"] = c.body_model;
    out["body"]["colour"] = vector_json(c.body_colour);
  }
  if (c.high.faces.rows() > 0) {
    out["high"] = mesh_json(writer, c.high);
    out["high"]["faceValid"] = writer.bytes(c.high_valid);
    if (c.garment_subdivisions >= 0)
      out["high"]["garmentSubdivisions"] = c.garment_subdivisions;
    if (!c.high_body.empty())
      out["high"]["bodyVertices"] = writer.integers({c.high_body.begin(), c.high_body.end()}, glb::Use::Data);
    if (texture_image >= 0) {
      out["high"]["texcoords"] = writer.matrix(c.texcoords);
      out["high"]["texture"] = texture_image;
    }
  }
  return out;
}

void parse_extension(const glb::Reader &reader, const json &j, Character &c) {
  c.name = j.at("name").get<std::string>();
  try {
    c.actor.skeleton = json_skeleton(j.at("skeleton"));
  } catch (const Error &error) {
    reader.fail(error.what());
  }
  const int joints = c.actor.skeleton.joint_count();
  c.actor.mesh = json_mesh(reader, j.at("mesh"));
  c.actor.face_valid = reader.bytes(j.at("mesh").at("faceValid").get<int>());
  c.actor.weights = reader.matrix(j.at("mesh").at("weights").get<int>(), joints);
  c.segmentation = json_clothness(reader, j.at("clothness"));
  c.proxies = json_proxies(j.at("proxies"));
  c.materials = json_materials(j.at("materials"));
  c.solver = json_solver(j.at("solver"), j.at("version").get<int>());
  if (j.contains("body")) {
    const json &body = j.at("body");
    c.body = json_mesh(reader, body);
    c.body_weights = reader.matrix(body.at("weights").get<int>(), joints);
    c.body_shown = reader.bytes(body.at("shown").get<int>());
    c.body_model = body.at("model").get<std::string>();
    c.body_colour = json_vector(body.at("colour"));
  }
  if (j.contains("high")) {
    const json &high = j.at("high");
    c.high = json_mesh(reader, high);
    c.high_valid = reader.bytes(high.at("faceValid").get<int>());
    c.garment_subdivisions = high.value("garmentSubdivisions", -1); // not in characters without a garment, or of before
    if (high.contains("bodyVertices"))
      for (std::uint32_t v : reader.integers(high.at("bodyVertices").get<int>()))
        c.high_body.push_back(static_cast<int>(std::min<std::uint32_t>(v, std::numeric_limits<int>::max())));
    if (high.contains("texcoords")) {
      c.texcoords = reader.matrix(high.at("texcoords").get<int>(), 2);
      c.texture = reader.image(high.at("texture").get<int>());
    }
  }
}

/// Rounds to what the file holds, so that what is derived from it (display weights, normals) is the same after a read.
template <class Matrix> void round_to_float(Matrix &m) {
  m = m.template cast<float>().template cast<double>().eval();
}

Character as_stored(Character c) {
  round_to_float(c.actor.mesh.vertices);
  round_to_float(c.actor.weights);
  round_to_float(c.segmentation.rest);
  round_to_float(c.body.vertices);
  round_to_float(c.body_weights);
  round_to_float(c.high.vertices);
  round_to_float(c.texcoords);
  return c;
}

/// What other viewers show: the skinned display mesh and the part of the body that cloth hides.
void add_display(glb::Writer &writer, const Character &c, int texture_image) {
  glb::add_joint_nodes(writer, c.actor.skeleton);
  const int skin = glb::add_skin(writer, c.actor.skeleton);
  const bool high = c.high.faces.rows() > 0;
  const int material = glb::add_material(writer, "surface", Eigen::Vector3d(0.8, 0.8, 0.8), texture_image, true);
  const glb::GlbMesh shown =
      high ? glb::surface_mesh(c.high, c.high_valid, c.texcoords) : glb::surface_mesh(c.actor.mesh, c.actor.face_valid, {});
  const MatrixRM weights = high ? DisplaySurface(c).skin_weights(c.actor.weights) : c.actor.weights;
  glb::add_mesh_node(writer, "surface", glb::add_mesh(writer, "surface", shown, material, &weights), skin);
  const glb::GlbMesh body = glb::display_mesh(c.body, c.body_shown, {});
  if (body.mesh.faces.rows() > 0) {
    const int skin_material = glb::add_material(writer, "body", c.body_colour, -1, false);
    glb::add_mesh_node(writer, "body", glb::add_mesh(writer, "body", body, skin_material, &c.body_weights), skin);
  }
}

} // namespace

void write_character(const std::filesystem::path &path, const Character &exact) {
  validate_character(exact);
  const Character character = as_stored(exact);
  glb::Writer writer;
  const int texture_image = character.texture.empty() ? -1 : writer.image(character.texture);
  add_display(writer, character, texture_image);
  writer.model.extensions[kExtension] = to_value(extension_json(writer, character, texture_image));
  writer.model.extensionsUsed.push_back(kExtension);
  writer.save(path);
}

Character read_character(const std::filesystem::path &path) {
  const glb::Reader reader(path);
  Character character;
  try {
    const json extensions = reader.gltf().value("extensions", json::object());
    if (!extensions.contains(kExtension))
      reader.fail(std::string("expected the glTF extension ") + kExtension + ", found a GLB without it");
    const json &extension = extensions.at(kExtension);
    const int version = extension.at("version").get<int>();
    if (version < 1 || version > kVersion)
      reader.fail(std::string(kExtension) + ": expected version 1 to " + std::to_string(kVersion) + ", found " +
                  std::to_string(version) + (version > kVersion ? ", which a newer doublet wrote" : ""));
    parse_extension(reader, extension, character);
  } catch (const json::exception &problem) {
    reader.fail(std::string(kExtension) + ": " + problem.what());
  } catch (const std::invalid_argument &problem) { // a name that nobody knows
    reader.fail(std::string(kExtension) + ": " + problem.what());
  }
  try {
    validate_character(character);
  } catch (const std::exception &problem) {
    reader.fail(problem.what());
  }
  return character;
}

} // namespace doublet
