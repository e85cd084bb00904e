// A character and a motion capture file give a new animation.
//   animate_character character.glb dance.bvh out.glb

#include "doublet/animate/animator.h"
#include "doublet/animate/baked_file.h"
#include "doublet/animate/character_file.h"
#include "doublet/animate/retarget.h"

#include <cstdio>
#include <exception>
#include <filesystem>

int main(int count, char **arguments) {
  if (count != 4) {
    std::fprintf(stderr, "usage: %s character.glb motion.bvh|motion.amc out.glb|out.npz\n", arguments[0]);
    return 2;
  }
  try {
    const doublet::Character character = doublet::read_character(arguments[1]);
    doublet::RetargetOptions options;
    options.fps = 1 / character.solver.dt;
    const doublet::Motion motion = doublet::retarget(doublet::read_motion_file(arguments[2]), character.actor.skeleton, options);
    doublet::Context context;
    context.progress = [](const std::string &stage, double done) {
      std::fprintf(stderr, "\r%s %3.0f %%", stage.c_str(), 100 * done);
    };
    const doublet::AnimationResult animation = doublet::animate(character, motion, {}, context);
    const std::filesystem::path out = arguments[3];
    if (out.extension() == ".npz")
      doublet::write_baked_npz(out, character, animation);
    else
      doublet::write_baked_glb(out, character, animation);
    std::fprintf(stderr, "\n%zu frames at %g 1/s\n", animation.surface.size(), animation.fps);
  } catch (const std::exception &error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
