#include "tracked_frame.h"

#include "doublet/core/error.h"

#include <algorithm>
#include <concepts>
#include <cstring>
#include <tuple>

namespace doublet {
namespace {

template <class T, class Struct>
concept Of = std::same_as<std::remove_const_t<T>, Struct>;

// The members of what is kept, each by a binding to all of them: one that is forgotten does not compile.
template <Of<FeatureMatch> T> auto members(T &match) {
  auto &[previous, current] = match;
  return std::tie(previous, current);
}
template <Of<SurfacePoint> T> auto members(T &point) {
  auto &[face, barycentric] = point;
  return std::tie(face, barycentric);
}
template <Of<SurfaceTrack> T> auto members(T &track) {
  auto &[view, surface, pixel, weight] = track;
  return std::tie(view, surface, pixel, weight);
}
template <Of<LostLimb> T> auto members(T &lost) {
  auto &[frame, limb, before, after, recovered] = lost;
  return std::tie(frame, limb, before, after, recovered);
}
template <Of<LimbRecord> T> auto members(T &limbs) {
  auto &[misses, next_search, steady_since] = limbs;
  return std::tie(misses, next_search, steady_since);
}
template <Of<TrackedFrame> T> auto members(T &frame) {
  auto &[index, searched, images, matches, mapped, dofs, surface, rim_px, sift_px, limbs, lost, seconds] = frame;
  return std::tie(index, searched, images, matches, mapped, dofs, surface, rim_px, sift_px, limbs, lost, seconds);
}

template <class T>
concept Struct = requires(T &value) {
  members(value);
};
template <class T>
concept EigenMatrix = requires {
  T::SizeAtCompileTime;
};
template <class T>
concept FixedSize = requires {
  std::tuple_size<T>::value;
}; // std::array

class Writer {
public:
  template <class T> void put(const T &value) {
    if constexpr (std::is_arithmetic_v<T>) {
      raw(&value, sizeof value);
    } else if constexpr (Struct<const T>) {
      std::apply([this](const auto &...member) { (this->put(member), ...); }, members(value));
    } else if constexpr (EigenMatrix<T>) {
      put(static_cast<std::uint64_t>(value.rows()));
      raw(value.data(), sizeof(*value.data()) * static_cast<std::size_t>(value.size()));
    } else {
      put(static_cast<std::uint64_t>(value.size()));
      for (const auto &element : value)
        put(element);
    }
  }
  std::string bytes;

private:
  void raw(const void *data, std::size_t size) { bytes.append(static_cast<const char *>(data), size); }
};

/// No count is trusted with an allocation that the bytes left cannot fill.
class Reader {
public:
  explicit Reader(const std::string &bytes) : at_(bytes.data()), left_(bytes.size()) {}

  template <class T> void get(T &value) {
    if constexpr (std::is_same_v<T, bool>) {
      value = number<std::uint8_t>() != 0;
    } else if constexpr (std::is_arithmetic_v<T>) {
      value = number<T>();
    } else if constexpr (Struct<T>) {
      std::apply([this](auto &...member) { (this->get(member), ...); }, members(value));
    } else if constexpr (EigenMatrix<T>) {
      static_assert(T::ColsAtCompileTime != Eigen::Dynamic, "rows are written, columns are not");
      constexpr std::size_t row = sizeof(typename T::Scalar) * T::ColsAtCompileTime;
      const std::size_t rows = count(row);
      require(T::RowsAtCompileTime == Eigen::Dynamic || rows == static_cast<std::size_t>(T::RowsAtCompileTime));
      value.resize(static_cast<Eigen::Index>(rows), T::ColsAtCompileTime);
      raw(value.data(), rows * row);
    } else {
      const std::size_t size = count(1);
      if constexpr (FixedSize<T>)
        require(size == value.size());
      else
        value.resize(size);
      for (auto &element : value)
        get(element);
    }
  }

  void require(bool right) const {
    if (!right)
      throw Error("expected a tracked frame, found other bytes");
  }
  bool at_end() const { return left_ == 0; }

private:
  template <class T> T number() {
    T value;
    raw(&value, sizeof value);
    return value;
  }
  std::size_t count(std::size_t bytes_each) {
    const auto n = number<std::uint64_t>();
    require(n <= left_ / bytes_each);
    return n;
  }
  void raw(void *data, std::size_t size) {
    require(size <= left_);
    if (size > 0)
      std::memcpy(data, at_, size);
    at_ += size;
    left_ -= size;
  }

  const char *at_;
  std::size_t left_;
};

} // namespace

std::string to_bytes(const TrackedFrame &frame) {
  Writer writer;
  writer.put(frame);
  return std::move(writer.bytes);
}

TrackedFrame from_bytes(const std::string &bytes) {
  TrackedFrame frame;
  Reader reader(bytes);
  reader.get(frame);
  reader.require(reader.at_end());
  return frame;
}

bool fits(const TrackedFrame &frame, const RiggedMesh &actor, std::size_t cameras, std::size_t limbs, bool first_pass) {
  const auto dofs = static_cast<std::size_t>(actor.skeleton.dof_count());
  const auto on_surface = [&](const SurfaceTrack &track) {
    return track.view >= 0 && static_cast<std::size_t>(track.view) < cameras && track.surface.face >= 0 &&
           track.surface.face < actor.mesh.faces.rows() && track.surface.barycentric.allFinite() && track.pixel.allFinite();
  };
  const auto finite = [](const FeatureMatch &match) { return match.previous.allFinite() && match.current.allFinite(); };
  return static_cast<std::size_t>(frame.dofs.size()) == dofs && frame.dofs.allFinite() &&
         frame.surface.rows() == actor.mesh.vertices.rows() && frame.surface.allFinite() && frame.limbs.misses.size() == limbs &&
         frame.limbs.next_search.size() == limbs && frame.limbs.steady_since.size() == dofs &&
         frame.matches.size() == (first_pass ? cameras : 0) &&
         std::all_of(frame.mapped.begin(), frame.mapped.end(), on_surface) &&
         std::all_of(frame.matches.begin(), frame.matches.end(),
                     [&](const auto &view) { return std::all_of(view.begin(), view.end(), finite); });
}

} // namespace doublet
