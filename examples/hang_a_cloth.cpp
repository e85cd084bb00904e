// Drops a cloth over a tapered capsule and writes it as a Wavefront OBJ file.
//   hang_a_cloth [cloth.obj]

#include <doublet/pbd/cloth_solver.h>

#include <cstdio>

int main(int argc, char **argv) {
  using namespace doublet::pbd;
  const int n = 41; // 1 m x 1 m in 40 x 40 squares, half a metre above the ground
  Vertices rest(n * n, 3);
  Faces faces(2 * (n - 1) * (n - 1), 3);
  for (int i = 0; i < n * n; ++i)
    rest.row(i) << (i % n) / 40.0 - 0.5, 0.5, (i / n) / 40.0 - 0.5;
  for (int q = 0; q < (n - 1) * (n - 1); ++q) {
    const int a = q / (n - 1) * n + q % (n - 1);
    faces.row(2 * q) << a, a + n, a + n + 1;
    faces.row(2 * q + 1) << a, a + n + 1, a + 1;
  }

  const auto solver =
      ClothSolver::create(ClothModel::create(rest, faces, Eigen::VectorXd::Ones(n * n))); // clothness 1: all of it is free
  ClothState state = initial_state(rest);
  Material cotton{.d_n = 5.0, .d_t = 0.5, .k_bend = 0.3, .k_stretch = 1.0, .k_friction = 0.9};
  const std::vector<Capsule> post{{{-0.25, 0.3, 0}, {0.25, 0.3, 0}, 0.15, 0.15}};
  StepInputs inputs; // one video frame: 1/40 s
  inputs.capsules = post;
  for (int frame = 0; frame < 30; ++frame)
    solver->step(state, inputs, cotton);

  std::FILE *file = std::fopen(argc > 1 ? argv[1] : "cloth.obj", "w");
  if (!file)
    return std::perror("cannot write the cloth"), 1;
  for (int i = 0; i < n * n; ++i)
    std::fprintf(file, "v %.6f %.6f %.6f\n", state.positions(i, 0), state.positions(i, 1), state.positions(i, 2));
  for (int f = 0; f < faces.rows(); ++f)
    std::fprintf(file, "f %d %d %d\n", faces(f, 0) + 1, faces(f, 1) + 1, faces(f, 2) + 1);
  return std::fclose(file) == 0 ? 0 : 1;
}
