#include "session_check/checks.h"

#include <algorithm>
#include <cmath>
#include <set>

namespace doublet::detail {
namespace {

constexpr int kLooks = 5; // frames at which ready masks are looked at

/// The frames that a camera filmed, spread over the take, or the first of them.
std::set<int> looked_at(const SessionCamera &camera, int frame_count, bool only_first) {
  const int last_of_all = frame_count - 1, first = std::clamp(-camera.late, 0, last_of_all),
            last = std::clamp(last_of_all - camera.late, first, last_of_all);
  if (only_first)
    return {first};
  std::set<int> frames;
  for (int i = 0; i < kLooks; ++i)
    frames.insert(first + static_cast<int>(std::nearbyint(static_cast<double>(i) * (last - first) / (kLooks - 1))));
  return frames;
}

/// Of one camera. shares: of the images that its masks cover, NaN where there is none.
Findings check_shares(const std::string &where, const std::string &kind, const std::vector<double> &shares) {
  const auto count_if = [&](const auto &is) { return static_cast<std::size_t>(std::count_if(shares.begin(), shares.end(), is)); };
  const std::size_t missing = count_if([](double share) { return std::isnan(share); }), known = shares.size() - missing;
  Findings found;
  const auto found_wrong = [&](const char *what, std::size_t count) {
    if (count > 0)
      found.push_back({2 * count > known, where + "expected " + kind + " that show a person, found " + what + " in " +
                                              std::to_string(count) + " of the " + std::to_string(known) + " looked at"});
  };
  found_wrong("nothing", count_if([](double share) { return share < kNoActor; }));
  found_wrong("the whole image", count_if([](double share) { return share > kAllActor; }));
  if (missing > 0)
    found.push_back({2 * known <= shares.size(), where + "expected " + kind + " for every frame, found none in " +
                                                     std::to_string(missing) + " of the " + std::to_string(shares.size()) +
                                                     " looked at"});
  return found;
}

} // namespace

Findings check_masks(Evidence &evidence) {
  Findings found;
  for (std::size_t c = 0; c < evidence.session.cameras.size(); ++c) {
    const SessionCamera &camera = evidence.session.cameras[c];
    const bool ready = !camera.masks.empty();
    std::vector<double> shares;
    for (const int frame : looked_at(camera, evidence.frames.frame_count(), !ready))
      shares.push_back(actor_share(evidence, static_cast<int>(c), frame));
    const Findings of_camera = check_shares("camera " + camera.name + ": ", ready ? "masks" : "silhouettes", shares);
    found.insert(found.end(), of_camera.begin(), of_camera.end());
  }
  return found;
}

} // namespace doublet::detail
