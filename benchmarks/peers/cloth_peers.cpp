// One frame of a skirt that hangs from a dancing waist, in our solver and in Bullet's: what peers.py compares, and the growth of
// ours with the number of vertices. Every time is CPU time of the process, ms.
//   cloth_peers scene  AROUND ROWS FRAMES FOLDER   the scene, for engines that are driven from Python
//   cloth_peers ours   AROUND ROWS FRAMES FOLDER   edges and bends only, as the peers; one simulation
//   cloth_peers ours8  AROUND ROWS FRAMES FOLDER   the same, 8 materials side by side, time per simulation; ours16: 16
//   cloth_peers full   AROUND ROWS FRAMES FOLDER   with drag, blend, proxies, friction and self-collision; one simulation
//   cloth_peers full8  AROUND ROWS FRAMES FOLDER   the same, 8 materials side by side; full16: 16
//   cloth_peers bullet AROUND ROWS FRAMES FOLDER
//   cloth_peers growth                             curtains from 1000 to 100000 vertices, as CSV

#include "doublet/pbd/detail/lanes.h"
#include "pbd/scenes.h"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <fstream>
#include <functional>
#include <stdexcept>
#include <string>
#ifdef DOUBLET_WITH_BULLET
#include <BulletSoftBody/btSoftBody.h>
#include <BulletSoftBody/btSoftBodyHelpers.h>
#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>
#include <BulletSoftBody/btSoftRigidDynamicsWorld.h>
#include <btBulletDynamicsCommon.h>
#endif

namespace {

using namespace doublet::pbd;

constexpr double kH = 1.0 / 40;
constexpr int kSweeps = 24, kSettle = 20; ///< frames before the clock starts

double cpu_ms() {
  std::timespec t;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return 1e3 * static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_nsec);
}

/// The skirt and where its waist is in every frame; row-major doubles and 32-bit integers, as numpy.fromfile reads them.
struct Scene {
  scenes::Sheet skirt;
  scenes::Dancer dancer;
  int around, frames;
  std::string folder;

  Scene(int around_, int rows, int frames_, std::string folder_)
      : skirt(scenes::skirt(around_, rows)), around(around_), frames(frames_), folder(std::move(folder_)) {}
  Vertices targets(int frame) const { return dancer.targets(skirt.rest, frame * kH); }
  void write(const char *name, const void *data, std::size_t bytes) const {
    std::ofstream file(folder + "/" + name, std::ios::binary);
    file.write(static_cast<const char *>(data), static_cast<std::streamsize>(bytes));
    if (!file.flush())
      throw std::runtime_error("cannot write " + folder + "/" + name);
  }
};

/// Runs `frame` once a frame and writes the times and the last positions as NAME.ms and NAME.positions.
void measure(const Scene &scene, const std::string &name, const std::function<void(int)> &prepare,
             const std::function<void()> &step, int share, const std::function<Vertices()> &positions) {
  std::vector<double> times;
  for (int f = 1; f <= scene.frames; ++f) {
    prepare(f);
    const double before = cpu_ms();
    step();
    if (f > kSettle)
      times.push_back((cpu_ms() - before) / share);
  }
  const Vertices x = positions();
  scene.write((name + ".ms").c_str(), times.data(), times.size() * sizeof(double));
  scene.write((name + ".positions").c_str(), x.data(), static_cast<std::size_t>(x.size()) * sizeof(double));
}

void write_scene(const Scene &scene) {
  const Vertices &rest = scene.skirt.rest;
  scene.write("rest", rest.data(), static_cast<std::size_t>(rest.size()) * sizeof(double));
  scene.write("faces", scene.skirt.faces.data(), static_cast<std::size_t>(scene.skirt.faces.size()) * sizeof(int));
  const auto model = ClothModel::create(rest, scene.skirt.faces, Eigen::VectorXd::Ones(rest.rows()));
  const Eigen::VectorXd masses = model->inverse_masses().cwiseInverse();
  scene.write("masses", masses.data(), static_cast<std::size_t>(masses.size()) * sizeof(double));
  Vertices waist((scene.frames + 1) * scene.around, 3);
  for (int f = 0; f <= scene.frames; ++f)
    waist.middleRows(f * scene.around, scene.around) = scene.targets(f).topRows(scene.around);
  scene.write("waist", waist.data(), static_cast<std::size_t>(waist.size()) * sizeof(double));
}

/// Materials around the one that Sect. 7 recovers; without drag and friction where the peers have none.
std::vector<Material> generation(bool everything, int samples) {
  std::vector<Material> materials;
  for (int i = 0; i < samples; ++i) {
    const double spread = samples == 1 ? 0 : 2.0 * i / (samples - 1) - 1;
    Material m{.d_n = 5.4 + spread, .d_t = 5.6 - spread, .k_bend = 0.75 + 0.2 * spread, .k_stretch = 1, .k_friction = 0.47};
    if (!everything)
      m.d_n = m.d_t = m.k_friction = 0;
    materials.push_back(m);
  }
  return materials;
}

void measure_ours(const Scene &scene, const std::string &name, bool everything, int samples) {
  ClothOptions options = ClothOptions::paper();
  options.iterations = kSweeps;
  options.self_collision = everything;
  Eigen::VectorXd clothness = scene.skirt.clothness; // the waist is pinned, the next two rings are blended
  if (!everything)
    clothness.tail(clothness.size() - scene.around).setOnes();
  const auto solver =
      detail::create_with_lanes(ClothModel::create(scene.skirt.rest, scene.skirt.faces, clothness, options), samples);
  const std::vector<Material> materials = generation(everything, samples);
  std::vector<ClothState> states(materials.size(), initial_state(scene.skirt.rest));
  Vertices previous = scene.targets(0), current = previous;
  std::vector<Capsule> previous_capsules, capsules = scene.dancer.capsules(0);
  measure(
      scene, name,
      [&](int f) {
        previous.swap(current);
        previous_capsules.swap(capsules);
        current = scene.targets(f);
        capsules = scene.dancer.capsules(f * kH);
      },
      [&] {
        StepInputs in;
        in.previous_targets = previous;
        in.targets = current;
        if (everything)
          in.previous_capsules = previous_capsules, in.capsules = capsules;
        solver->step_batch(states, {&in, 1}, materials);
      },
      samples, [&] { return states[0].positions; });
}

#ifdef DOUBLET_WITH_BULLET
/// Edges as links, bending as links between vertices two edges apart (Bullet has no angles); no collisions, no drag.
void measure_bullet(const Scene &scene) {
  btSoftBodyRigidBodyCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher(&configuration);
  btDbvtBroadphase broadphase;
  btSequentialImpulseConstraintSolver rigid;
  btSoftRigidDynamicsWorld world(&dispatcher, &broadphase, &rigid, &configuration);
  world.setGravity({0, btScalar(-9.81), 0});
  world.getWorldInfo().m_gravity = {0, btScalar(-9.81), 0};
  world.getWorldInfo().air_density = 0;

  const Vertices &rest = scene.skirt.rest;
  const int n = static_cast<int>(rest.rows());
  const std::vector<btScalar> points(rest.data(), rest.data() + rest.size());
  btSoftBody *body = btSoftBodyHelpers::CreateFromTriMesh(world.getWorldInfo(), points.data(), scene.skirt.faces.data(),
                                                          static_cast<int>(scene.skirt.faces.rows()), false);
  btSoftBody::Material *bending = body->appendMaterial();
  bending->m_kLST = btScalar(0.75);
  body->m_materials[0]->m_kLST = 1;
  body->generateBendingConstraints(2, bending);
  body->m_cfg.piterations = kSweeps;
  body->m_cfg.collisions = 0;
  body->m_cfg.kDP = 0;
  const Eigen::VectorXd w =
      ClothModel::create(rest, scene.skirt.faces, Eigen::VectorXd::Ones(n))->inverse_masses(); // a third of the areas
  for (int i = 0; i < n; ++i)
    body->setMass(i, i < scene.around ? 0 : btScalar(1 / w[i]));
  btSoftBodyHelpers::ReoptimizeLinkOrder(body); // Bullet's own order for speed
  world.addSoftBody(body);
  measure(
      scene, "bullet",
      [&](int f) {
        const Vertices waist = scene.targets(f);
        for (int i = 0; i < scene.around; ++i)
          body->m_nodes[i].m_x = {btScalar(waist(i, 0)), btScalar(waist(i, 1)), btScalar(waist(i, 2))};
      },
      [&] { world.stepSimulation(btScalar(kH), 1, btScalar(kH)); }, 1,
      [&] {
        Vertices x(n, 3);
        for (int i = 0; i < n; ++i)
          x.row(i) << body->m_nodes[i].m_x.x(), body->m_nodes[i].m_x.y(), body->m_nodes[i].m_x.z();
        return x;
      });
  world.removeSoftBody(body);
  delete body;
}
#else
void measure_bullet(const Scene &) {
  throw std::runtime_error("built without Bullet: install libbullet-dev and build again");
}
#endif

/// A curtain of 25 rows, hung by its top edge that waves, ever wider: the same cloth at every size. Median ms a frame of one
/// simulation when `lanes` run side by side.
double curtain_ms(const scenes::Sheet &curtain, int columns, bool everything, int lanes) {
  ClothOptions options = ClothOptions::paper();
  options.self_collision = everything;
  const auto solver =
      detail::create_with_lanes(ClothModel::create(curtain.rest, curtain.faces, curtain.clothness, options), lanes);
  const std::vector<Material> materials = generation(everything, lanes);
  std::vector<ClothState> states(materials.size(), initial_state(curtain.rest));
  Vertices previous = curtain.rest, current = previous;
  std::vector<double> times;
  for (int f = 1; f <= kSettle + 20; ++f) {
    previous.swap(current);
    current = curtain.rest;
    for (int c = 0; c <= columns; ++c)
      current(c, 2) += 0.05 * std::sin(6 * f * kH + 20 * curtain.rest(c, 0));
    StepInputs in;
    in.previous_targets = previous;
    in.targets = current;
    const double start = cpu_ms();
    solver->step_batch(states, {&in, 1}, materials);
    if (f > kSettle)
      times.push_back((cpu_ms() - start) / lanes);
  }
  std::nth_element(times.begin(), times.begin() + 10, times.end());
  return times[10];
}

void print_growth() {
  const int widest = detail::supported_lanes().back();
  std::printf("vertices,faces,edges_and_bends_1,everything_1,edges_and_bends_%d,everything_%d\n", widest, widest);
  for (int columns : {39, 79, 159, 399, 799, 1599, 3999}) {
    scenes::Sheet curtain = scenes::grid(columns, 24, 0.025);
    curtain.rest.col(1) = -curtain.rest.col(2).eval();
    curtain.rest.col(2).setZero();
    curtain.clothness.head(columns + 1).setZero();
    std::printf("%d,%d", static_cast<int>(curtain.rest.rows()), static_cast<int>(curtain.faces.rows()));
    for (int lanes : {1, widest})
      for (bool everything : {false, true})
        std::printf(",%.4f", curtain_ms(curtain, columns, everything, lanes));
    std::printf("\n");
    std::fflush(stdout);
  }
}

} // namespace

int main(int argc, char **argv) {
  const std::string what = argc > 1 ? argv[1] : "";
  try {
    if (what == "growth" && argc == 2)
      return print_growth(), 0;
    if (argc != 6)
      throw std::invalid_argument(
          "usage: cloth_peers scene|ours|ours8|ours16|full|full8|full16|bullet AROUND ROWS FRAMES FOLDER, or growth");
    const Scene scene(std::stoi(argv[2]), std::stoi(argv[3]), std::stoi(argv[4]), argv[5]);
    if (what == "scene")
      write_scene(scene);
    else if (what == "bullet")
      measure_bullet(scene);
    else if (what.rfind("ours", 0) == 0 || what.rfind("full", 0) == 0)
      measure_ours(scene, what, what[0] == 'f', what.size() > 4 ? std::stoi(what.substr(4)) : 1);
    else
      throw std::invalid_argument("no engine called " + what);
  } catch (const std::exception &e) {
    std::fprintf(stderr, "cloth_peers: %s\n", e.what());
    return 1;
  }
}
