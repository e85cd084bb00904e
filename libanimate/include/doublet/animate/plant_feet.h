#pragma once
// Foot planting: contacts are found from height and speed, the legs hold planted feet on the floor, no foot is below it.

#include "doublet/animate/motion.h"
#include "doublet/options/options.h"

namespace doublet {

struct PlantOptions {
  double contact_height = 0.05;
  double contact_speed = 0.35;
  double blend_seconds = 0.15;
  double max_pelvis_drop = 0.08;
  double floor_height = 0;
  static constexpr auto describe() {
    using namespace options;
    using O = PlantOptions;
    return Description{
        "PlantOptions",
        option(&O::contact_height, "contact_height", Range{0, 1}, "m",
               "Heel or ball may stand if this close to the lowest point within 0.75 s", "A contact ends at 1.4 times it"),
        option(&O::contact_speed, "contact_speed", Range{0, 10}, "m/s", "Heel or ball may stand if it is as slow as this",
               "A contact ends at 1.6 times it"),
        option(&O::blend_seconds, "blend_seconds", Range{0, 2}, "s",
               "Time in which a foot blends between its own path and where it stands"),
        option(&O::max_pelvis_drop, "max_pelvis_drop", Range{0, 0.5}, "m",
               "The pelvis is lowered by up to this so that feet reach where they stand", "Beyond that the feet are released"),
        option(&O::floor_height, "floor_height", Range{}, "m", "Height of the floor that the feet stand on in the rest pose"),
    };
  }
  void validate() const; ///< throws std::invalid_argument naming option, range and value
};

/// Contacts of heel and ball of one foot, one flag per frame.
struct FootContacts {
  std::string ankle; ///< joint
  Mask heel, ball;
};

/// The frames in which the feet of the motion stand. Only feet of legs that can be planted: hip (ball), knee (one hinge), ankle
/// and toe with their standard names. Throws std::invalid_argument as plant_feet.
std::vector<FootContacts> find_contacts(const Skeleton &skeleton, const Motion &motion, const PlantOptions &options = {});

/// The motion with planted feet: the height of the floor under it, estimated from the contacts, is subtracted frame by frame; the
/// part that a foot stands on (heel, ball, then tip) does not move; no foot is below the floor. Only the root's height, hips,
/// knees and ankles change. Phases in the air stay in the air. Throws std::invalid_argument unless the motion has frames, a rate
/// in [0.1, 10000] 1/s, and the skeleton's degrees of freedom.
Motion plant_feet(const Skeleton &skeleton, const Motion &motion, const PlantOptions &options = {});

} // namespace doublet
