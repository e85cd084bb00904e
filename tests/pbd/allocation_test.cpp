// A step allocates nothing once its solver has been through a motion of the kind: every allocation of this program is counted.

#include "scenes.h"

#include <atomic>
#include <cstdlib>
#include <gtest/gtest.h>
#include <new>

namespace {

std::atomic<long> allocations{0};

void *counted_or_null(std::size_t bytes, std::size_t alignment) noexcept {
  ++allocations;
  return std::aligned_alloc(alignment, (bytes + alignment) / alignment * alignment);
}

void *counted(std::size_t bytes, std::size_t alignment) {
  if (void *block = counted_or_null(bytes, alignment))
    return block;
  throw std::bad_alloc();
}

} // namespace

void *operator new(std::size_t bytes) {
  return counted(bytes, alignof(std::max_align_t));
}
void *operator new(std::size_t bytes, std::align_val_t alignment) {
  return counted(bytes, static_cast<std::size_t>(alignment));
}
// Of std::stable_sort. The standard library's calls the one above; AddressSanitizer's does not, and would miss it when freed
// here.
void *operator new(std::size_t bytes, const std::nothrow_t &) noexcept {
  return counted_or_null(bytes, alignof(std::max_align_t));
}
void operator delete(void *block) noexcept {
  std::free(block);
}
void operator delete(void *block, std::size_t) noexcept {
  std::free(block);
}
void operator delete(void *block, std::align_val_t) noexcept {
  std::free(block);
}
void operator delete(void *block, std::size_t, std::align_val_t) noexcept {
  std::free(block);
}

namespace doublet::pbd {
namespace {

/// One frame of a dance, kept so that playing it allocates nothing.
struct Frame {
  Vertices targets;
  std::vector<Capsule> capsules;
};

TEST(Allocation, AWarmStepAllocatesNothing) {
  const scenes::Sheet s = scenes::skirt(26, 10);
  const scenes::Dancer dancer{1.4};
  std::vector<Frame> frames;
  for (int f = 0; f <= 40; ++f)
    frames.push_back({dancer.targets(s.rest, f / 40.0), dancer.capsules(f / 40.0)});
  const auto inputs = [&](int f) {
    StepInputs in;
    in.previous_targets = frames[f - 1].targets;
    in.targets = frames[f].targets;
    in.previous_capsules = frames[f - 1].capsules;
    in.capsules = frames[f].capsules;
    return in;
  };
  for (Stiffness stiffness : {Stiffness::Sweeps, Stiffness::Compliance}) {
    ClothOptions options = ClothOptions::paper();
    options.iterations = 8;
    options.substeps = 2;
    options.restitution = 0.5;
    options.self_thickness = 0.008;
    options.stiffness = stiffness;
    options.edge_collision = stiffness == Stiffness::Compliance;
    const auto solver = ClothSolver::create(ClothModel::create(s.rest, s.faces, s.clothness, options));
    std::vector<Material> materials(21);
    materials[3].k_damping = 0.5;
    const std::vector<ClothState> start(materials.size(), initial_state(s.rest));
    std::vector<ClothState> states = start;
    ClothState single = start[0];
    const auto play = [&] {
      for (int f = 1; f <= 40; ++f) {
        const StepInputs in = inputs(f);
        solver->step_batch(states, {&in, 1}, materials);
        solver->step(single, in, materials[3]);
      }
    };
    play();
    states = start;
    single = start[0];
    const long before = allocations;
    play();
    EXPECT_EQ(allocations - before, 0);
    EXPECT_GT(before, 100); // they are counted
    EXPECT_GT((single.positions - s.rest).cwiseAbs().maxCoeff(), 0.05);
  }
}

} // namespace
} // namespace doublet::pbd
