#pragma once
// Boxes in a row, and what they hold: ways of vertices, edges, faces.

#include "face_boxes.h"

namespace doublet::pbd {
inline namespace DOUBLET_PBD_ISA {

template <class T> class BoxList {
public:
  void resize(int size) { boxes_.resize(size); }
  void set(int i, const Box<T> &box) { boxes_[i] = box; }
  Box<T> operator[](int i) const { return boxes_[i]; }
  /// Calls found(i, lanes) for the boxes i in [first, last) that overlap `query` in some of the lanes `may`, in their order.
  template <class M, class Found> void for_each_overlap(int first, int last, const Box<T> &query, M may, Found &&found) const {
    for (int i = first; i < last; ++i) {
      const auto lanes = may & overlap(query, boxes_[i]);
      if (any(lanes))
        found(i, lanes);
    }
  }

private:
  Array<Box<T>> boxes_;
};

/// For one simulation a row of boxes is compared side by side.
template <> class BoxList<float> {
public:
  void resize(int size) {
    Array<float> *const all[] = {&lo_x_, &lo_y_, &lo_z_, &hi_x_, &hi_y_, &hi_z_};
    for (Array<float> *bounds : all)
      bounds->resize(size + kRow); // the last row may reach beyond the last box
  }
  void set(int i, const Box<float> &box) {
    lo_x_[i] = box.lo.x, lo_y_[i] = box.lo.y, lo_z_[i] = box.lo.z;
    hi_x_[i] = box.hi.x, hi_y_[i] = box.hi.y, hi_z_[i] = box.hi.z;
  }
  /// Those from i on.
  void set_row(int i, const Box<Row> &box) {
    const auto store = [i](Array<float> &to, Row from) { __builtin_memcpy(&to[i], &from.lanes, sizeof from.lanes); };
    store(lo_x_, box.lo.x), store(lo_y_, box.lo.y), store(lo_z_, box.lo.z);
    store(hi_x_, box.hi.x), store(hi_y_, box.hi.y), store(hi_z_, box.hi.z);
  }
  Box<float> operator[](int i) const { return {{lo_x_[i], lo_y_[i], lo_z_[i]}, {hi_x_[i], hi_y_[i], hi_z_[i]}}; }
  template <class Found> void for_each_overlap(int first, int last, const Box<float> &query, bool may, Found &&found) const {
    if (may)
      for_each_row(first, last, query, [&](int i, int overlaps) { for_each_bit(overlaps, [&](int l) { found(i + l, true); }); });
  }
  /// Calls use(i, overlaps) for the boxes in [first, last), a row at a time. Bit l: box i + l overlaps.
  template <class Use> void for_each_row(int first, int last, const Box<float> &query, Use &&use) const {
    const Box<Row> all{{Row(query.lo.x), Row(query.lo.y), Row(query.lo.z)}, {Row(query.hi.x), Row(query.hi.y), Row(query.hi.z)}};
    for (int i = first; i < last; i += kRow) {
      const int overlaps = lane_bits(overlap(all, row(i)));
      use(i, last - i < kRow ? overlaps & ((1 << (last - i)) - 1) : overlaps);
    }
  }

private:
  Box<Row> row(int i) const {
    return {{Row::load(&lo_x_[i]), Row::load(&lo_y_[i]), Row::load(&lo_z_[i])},
            {Row::load(&hi_x_[i]), Row::load(&hi_y_[i]), Row::load(&hi_z_[i])}};
  }
  Array<float> lo_x_, lo_y_, lo_z_, hi_x_, hi_y_, hi_z_;
};

/// Boxes of one simulation those of which in a row lie together: one box around the row is asked before.
class RowsOfBoxes {
public:
  void resize(int count) {
    count_ = count;
    boxes_.resize(count);
    rows_.resize(row_of(count + kRow - 1));
  }
  void set(int i, const Box<float> &box) { boxes_.set(i, box); }
  void set_row(int i, const Box<Row> &box) { boxes_.set_row(i, box); }
  Box<float> operator[](int i) const { return boxes_[i]; }
  /// After the last box was set.
  void refit() {
    for (int first = 0; first < count_; first += kRow) {
      Box<float> all = boxes_[first];
      for (int i = first + 1; i < end_of(row_of(first)); ++i)
        all = united(all, boxes_[i]);
      rows_.set(row_of(first), all);
    }
  }
  /// Of one alone, after refit().
  void replace(int i, const Box<float> &box) {
    boxes_.set(i, box);
    rows_.set(row_of(i), united(rows_[row_of(i)], box));
  }
  /// As in BoxList.
  template <class Found> void for_each_overlap(int first, int last, const Box<float> &query, bool may, Found &&found) const {
    rows_.for_each_overlap(row_of(first), row_of(last + kRow - 1), query, may, [&](int r, bool) {
      boxes_.for_each_overlap(kRow * r < first ? first : kRow * r, end_of(r) < last ? end_of(r) : last, query, true, found);
    });
  }

private:
  static int row_of(int i) { return i / kRow; }
  int end_of(int row) const { return kRow * (row + 1) < count_ ? kRow * (row + 1) : count_; }
  int count_ = 0;
  BoxList<float> boxes_, rows_;
};

struct IndexPair {
  int i, j;
};
#ifdef __AVX2__
/// For every set of lanes which of them come first, in the order in which unpacking brings them back.
struct FirstLanes {
  unsigned char lane[256][8];
  constexpr FirstLanes() : lane{} {
    constexpr int unpacked[8] = {0, 1, 4, 5, 2, 3, 6, 7};
    for (int bits = 0; bits < 256; ++bits) {
      int count = 0;
      for (int l = 0; l < 8; ++l)
        if (bits >> l & 1)
          lane[bits][unpacked[count++]] = static_cast<unsigned char>(l);
    }
  }
};
inline constexpr FirstLanes kFirstLanes;
inline void store_pairs(int i, int j, int bits, IndexPair *to) {
  const __m256i lanes = _mm256_cvtepu8_epi32(_mm_loadl_epi64(reinterpret_cast<const __m128i *>(kFirstLanes.lane[bits])));
  const __m256i first = _mm256_set1_epi32(i), second = _mm256_add_epi32(_mm256_set1_epi32(j), lanes);
  _mm256_storeu_si256(reinterpret_cast<__m256i *>(to), _mm256_unpacklo_epi32(first, second));
  _mm256_storeu_si256(reinterpret_cast<__m256i *>(to + 4), _mm256_unpackhi_epi32(first, second));
}
#else
inline void store_pairs(int i, int j, int bits, IndexPair *to) {
  for (int l = 0; l < kRow; ++l) {
    *to = {i, j + l};
    to += bits >> l & 1;
  }
}
#endif
/// Adds (i, j + l) for every bit l that is set. Without a jump that nobody can foretell.
inline void add_pairs(int i, int j, int bits, Array<IndexPair> &to) {
  store_pairs(i, j, bits, to.spare(kRow));
  to.resize(to.size() + __builtin_popcount(static_cast<unsigned>(bits)));
}

/// What a box becomes in a list: `margin` wider on each side, and nothing where it is then wider than `largest`.
struct Margin {
  float margin, largest;
  template <class T> Box<T> operator()(const Box<T> &box) const { return bounded(grown(box, T(margin)), T(largest)); }
};

/// Calls use(row, count, there) for the pairs, a row at a time: its first pair, how many there are, and their lanes.
template <class Use> inline void for_each_row(const Array<IndexPair> &pairs, const Use &use) {
  for (int first = 0; first < pairs.size(); first += kRow) {
    const int left = pairs.size() - first, count = left < kRow ? left : kRow;
    float there[kRow];
    for (int l = 0; l < kRow; ++l)
      there[l] = l < count ? 1 : 0;
    use(pairs.data() + first, count, Row::load(there) > Row(0));
  }
}
/// Where the vertices vertex(l) of a row are; from lane `count` on that of the first.
template <class Vertex> inline Vec3<Row> gather_row(const Array<Point> &points, int count, const Vertex &vertex) {
  int v[kRow];
  for (int l = 0; l < kRow; ++l)
    v[l] = vertex(l < count ? l : 0);
  return gather<kRow>(points.data(), v);
}

/// boxes[i]: the box around both ends of the ways of the vertices corners[k][i], with its margin. lo, hi: of each vertex's way.
template <int n, class T, class Points>
inline void set_boxes(const Points &lo, const Points &hi, int count, const int *const (&corners)[n], const Margin &margin,
                      BoxList<T> &boxes) {
  boxes.resize(count);
  for (int i = 0; i < count; ++i) {
    Box<T> box{lo[corners[0][i]], hi[corners[0][i]]};
    for (int k = 1; k < n; ++k)
      box = united(box, Box<T>{lo[corners[k][i]], hi[corners[k][i]]});
    boxes.set(i, margin(box));
  }
}
template <int n>
inline void set_boxes(const Array<Point> &lo, const Array<Point> &hi, int count, const int *const (&corners)[n],
                      const Margin &margin, BoxList<float> &boxes) {
  boxes.resize(count);
  for (int first = 0; first < count; first += kRow) {
    const auto box_of_corner = [&](int k) {
      const auto vertex = [&](int l) { return corners[k][first + l]; };
      return Box<Row>{gather_row(lo, count - first, vertex), gather_row(hi, count - first, vertex)};
    };
    Box<Row> box = box_of_corner(0);
    for (int k = 1; k < n; ++k)
      box = united(box, box_of_corner(k));
    boxes.set_row(first, margin(box));
  }
}

} // namespace DOUBLET_PBD_ISA
} // namespace doublet::pbd
