// What JavaScript sees of doublet::Player: numbers and addresses. One player a module; worker.js is the only caller.

#include "doublet/animate/player.h"
#include "doublet/animate/character_file.h"
#include "doublet/animate/motion_file.h"
#include "doublet/animate/parts/arm_penetration.h"
#include "doublet/animate/retarget.h"

#include <emscripten/emscripten.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <string>

using namespace doublet;

namespace {

/// Triangles as a graphics card takes them: vertices that have one place and two texture coordinates are two.
class DrawnSurface {
public:
  DrawnSurface() = default;
  DrawnSurface(const Faces &faces, const std::vector<std::uint8_t> &shown, const TexCoords &corners) {
    std::map<std::array<double, 3>, int> known; // vertex and texture coordinates -> drawn vertex
    for (int f = 0; f < faces.rows(); ++f)
      for (int k = 0; k < 3 && shown[f]; ++k) {
        const Eigen::RowVector2d at = corners.rows() > 0 ? corners.row(3 * f + k) : Eigen::RowVector2d(0, 0);
        const auto [found, is_new] = known.try_emplace({double(faces(f, k)), at.x(), at.y()}, static_cast<int>(vertices_.size()));
        if (is_new) {
          vertices_.push_back(faces(f, k));
          texcoords.insert(texcoords.end(), {static_cast<float>(at.x()), static_cast<float>(at.y())});
        }
        triangles.push_back(found->second);
        corners_.push_back(faces(f, k));
      }
    positions.resize(3 * vertices_.size());
    normals.resize(positions.size());
  }

  void move_to(const Vertices &vertices) {
    sums_.assign(3 * vertices.rows(), 0.0f);
    const double *x = vertices.data();
    for (std::size_t i = 0; i < corners_.size(); i += 3) {
      const double *a = x + 3 * corners_[i], *b = x + 3 * corners_[i + 1], *c = x + 3 * corners_[i + 2];
      const auto u = [&](int k) { return static_cast<float>(b[k] - a[k]); };
      const auto v = [&](int k) { return static_cast<float>(c[k] - a[k]); };
      const float area[3] = {u(1) * v(2) - u(2) * v(1), u(2) * v(0) - u(0) * v(2), u(0) * v(1) - u(1) * v(0)};
      for (int corner = 0; corner < 3; ++corner)
        for (int k = 0; k < 3; ++k)
          sums_[3 * corners_[i + corner] + k] += area[k];
    }
    for (std::size_t i = 0; i < vertices_.size(); ++i) {
      const float *n = &sums_[3 * vertices_[i]];
      const float scale = 1 / std::max(std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]), 1e-20f);
      for (int k = 0; k < 3; ++k) {
        positions[3 * i + k] = static_cast<float>(x[3 * vertices_[i] + k]);
        normals[3 * i + k] = scale * n[k];
      }
    }
  }

  std::vector<int> triangles;
  std::vector<float> texcoords, positions, normals;

private:
  std::vector<int> corners_;  ///< of the drawn faces, in the mesh
  std::vector<int> vertices_; ///< of the mesh, for each that is drawn
  std::vector<float> sums_;   ///< of area vectors, of each of the mesh
};

struct View {
  View(Character character, const AnimateOptions &options) : player(std::move(character), options) {
    const Character &c = player.character();
    has_high = c.high.faces.rows() > 0;
    surface = has_high ? DrawnSurface(c.high.faces, c.high_valid, c.texcoords)
                       : DrawnSurface(c.actor.mesh.faces, c.actor.face_valid, {});
    body = DrawnSurface(c.body.faces, c.body_shown, {});
  }
  void show() {
    const AnimationFrame &frame = player.frame();
    surface.move_to(has_high ? frame.high : frame.surface);
    body.move_to(frame.body);
  }
  Eigen::VectorXd pose(const double *dofs) const {
    return Eigen::Map<const Eigen::VectorXd>(dofs, player.character().actor.skeleton.dof_count());
  }

  Player player;
  bool has_high;
  DrawnSurface surface, body;
  CharacterState begun; ///< the cloth of the last reset
  Motion clip;          ///< the last that was retargeted
};

std::optional<View> view;
std::string problem;

/// 1, or 0 and a sentence in `problem`.
template <class Work> int attempt(const Work &work) {
  try {
    work();
    return 1;
  } catch (const std::exception &error) {
    problem = error.what();
    return 0;
  }
}

DrawnSurface &drawn(int which) {
  return which == 0 ? view->surface : view->body;
}

} // namespace

extern "C" {

EMSCRIPTEN_KEEPALIVE const char *player_problem() {
  return problem.c_str();
}
EMSCRIPTEN_KEEPALIVE int player_open(const char *path, double settle_seconds) {
  return attempt([&] {
    AnimateOptions options;
    options.settle_seconds = settle_seconds;
    options.edge_collision = false; // a browser has one lane and no time for it
    view.emplace(read_character(path), options);
  });
}
EMSCRIPTEN_KEEPALIVE int player_dof_count() {
  return view->player.character().actor.skeleton.dof_count();
}
EMSCRIPTEN_KEEPALIVE double player_dt() {
  return view->player.character().solver.dt;
}
EMSCRIPTEN_KEEPALIVE int player_region_count() {
  return static_cast<int>(view->player.materials().size());
}
EMSCRIPTEN_KEEPALIVE int player_cloth_vertex_count() {
  int count = 0;
  for (const pbd::ClothState &cloth : view->player.state().regions)
    count += static_cast<int>(cloth.positions.rows());
  return count;
}

/// A .bvh, .fbx or .glb, retargeted to the character at its own rate.
EMSCRIPTEN_KEEPALIVE int clip_open(const char *path) {
  return attempt([&] {
    const Character &character = view->player.character();
    RetargetOptions options;
    options.fps = 1 / character.solver.dt;
    Context context;
    context.threads = 1;
    const Motion clip = retarget(read_motion_file(path), character.actor.skeleton, options);
    view->clip = resolve_arm_penetration(character, clip, context);
  });
}
EMSCRIPTEN_KEEPALIVE int clip_frame_count() {
  return static_cast<int>(view->clip.dofs.rows());
}
EMSCRIPTEN_KEEPALIVE const double *clip_poses() {
  return view->clip.dofs.data();
}
/// The degree of freedom that turns the root about +Y, -1 = none.
EMSCRIPTEN_KEEPALIVE int player_turning_dof() {
  const std::vector<std::string> &names = view->player.character().actor.skeleton.dof_names;
  const auto found = std::find_if(names.begin(), names.end(), [](const std::string &name) { return name.ends_with(".ry"); });
  return found == names.end() ? -1 : static_cast<int>(found - names.begin());
}

EMSCRIPTEN_KEEPALIVE int player_reset(const double *dofs) {
  return attempt([&] {
    view->player.reset(view->pose(dofs));
    view->begun = view->player.state();
  });
}
/// As after player_reset(), which came before, without the seconds that the cloth takes to fall into place.
EMSCRIPTEN_KEEPALIVE int player_begin_again(const double *dofs) {
  return attempt([&] {
    view->player.set_state(view->begun);
    view->player.teleport(view->pose(dofs)); // carries the cloth along from wherever the actor stood
    view->player.set_state(view->begun);
  });
}
EMSCRIPTEN_KEEPALIVE int player_step(const double *dofs) {
  return attempt([&] { view->player.step(view->pose(dofs)); });
}

/// The cloth of each region in turn: its positions, its velocities.
EMSCRIPTEN_KEEPALIVE int player_set_cloth(const double *values) {
  return attempt([&] {
    CharacterState state = view->player.state();
    for (pbd::ClothState &cloth : state.regions)
      for (Vertices *rows : {&cloth.positions, &cloth.velocities}) {
        std::copy_n(values, rows->size(), rows->data());
        values += rows->size();
      }
    view->player.set_state(state);
  });
}
EMSCRIPTEN_KEEPALIVE int player_set_material(int region, int parameter, double value) {
  return attempt([&] {
    std::vector<pbd::Material> materials = view->player.materials();
    materials.at(region).*pbd::material_parameters().at(parameter).value = value;
    view->player.set_materials(materials);
  });
}
EMSCRIPTEN_KEEPALIVE double player_material(int region, int parameter) {
  return view->player.materials().at(region).*pbd::material_parameters().at(parameter).value;
}
EMSCRIPTEN_KEEPALIVE int player_set_wind(double x, double y, double z) {
  return attempt([&] { view->player.set_wind({x, y, z}); });
}
EMSCRIPTEN_KEEPALIVE int player_set_gravity(double x, double y, double z) {
  return attempt([&] { view->player.set_gravity({x, y, z}); });
}

/// Brings what is drawn to the frame.
EMSCRIPTEN_KEEPALIVE void drawn_update() {
  view->show();
}
// What is drawn: 0 = the surface, 1 = the body under it. Addresses hold until the next call.
EMSCRIPTEN_KEEPALIVE int drawn_triangle_count(int which) {
  return static_cast<int>(drawn(which).triangles.size()) / 3;
}
EMSCRIPTEN_KEEPALIVE const int *drawn_triangles(int which) {
  return drawn(which).triangles.data();
}
EMSCRIPTEN_KEEPALIVE int drawn_vertex_count(int which) {
  return static_cast<int>(drawn(which).texcoords.size()) / 2;
}
EMSCRIPTEN_KEEPALIVE const float *drawn_texcoords(int which) {
  return drawn(which).texcoords.data();
}
EMSCRIPTEN_KEEPALIVE const float *drawn_positions(int which) {
  return drawn(which).positions.data();
}
EMSCRIPTEN_KEEPALIVE const float *drawn_normals(int which) {
  return drawn(which).normals.data();
}
EMSCRIPTEN_KEEPALIVE int texture_bytes() {
  return static_cast<int>(view->player.character().texture.size());
}
EMSCRIPTEN_KEEPALIVE const std::uint8_t *texture() {
  return view->player.character().texture.data();
}
EMSCRIPTEN_KEEPALIVE double body_colour(int channel) {
  return view->player.character().body_colour[channel];
}

// The frame as Player has it, for the comparison with another build of it.
EMSCRIPTEN_KEEPALIVE const double *frame_surface() {
  return view->player.frame().surface.data();
}
EMSCRIPTEN_KEEPALIVE int frame_surface_rows() {
  return static_cast<int>(view->player.frame().surface.rows());
}
EMSCRIPTEN_KEEPALIVE const double *frame_high() {
  return view->player.frame().high.data();
}
EMSCRIPTEN_KEEPALIVE int frame_high_rows() {
  return static_cast<int>(view->player.frame().high.rows());
}
EMSCRIPTEN_KEEPALIVE const double *frame_body() {
  return view->player.frame().body.data();
}
EMSCRIPTEN_KEEPALIVE int frame_body_rows() {
  return static_cast<int>(view->player.frame().body.rows());
}
}
