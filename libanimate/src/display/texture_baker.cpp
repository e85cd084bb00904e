#include "doublet/animate/texture_baker.h"

#include "doublet/animate/display_surface.h"
#include "doublet/animate/parts/image_file.h"
#include "doublet/core/error.h"
#include "doublet/core/parts/face_neighbours.h"
#include "face_views.h"
#include "garment_part.h"
#include "hidden_skin.h"
#include "texture_charts.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <optional>

namespace doublet {
namespace {

using detail::FaceView;
using detail::FilmedFaces;
using detail::kGamma;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::Vector3f;

void require_length(const std::string &who, const std::string &what, std::size_t found, Eigen::Index expected) {
  if (static_cast<Eigen::Index>(found) != expected)
    throw std::invalid_argument(who + ": " + what + " has " + std::to_string(found) + " entries, expected " +
                                std::to_string(expected));
}

void require_inputs(const std::string &who, const Mesh &mesh, const std::vector<std::uint8_t> &valid, const CameraRig &cameras,
                    const std::vector<Image> &images, const std::vector<Image> &masks) {
  require_usable(mesh, who + ": mesh");
  if (!valid.empty())
    require_length(who, "face_valid", valid.size(), mesh.faces.rows());
  for (const Camera &camera : cameras)
    validate_camera(camera, who);
  if (images.size() != cameras.size())
    throw std::invalid_argument(who + ": expected one image per camera, found " + std::to_string(images.size()) + " for " +
                                std::to_string(cameras.size()));
  for (std::size_t c = 0; c < images.size(); ++c)
    if (!images[c].empty() &&
        (images[c].channels != 3 || images[c].width != cameras[c].width || images[c].height != cameras[c].height))
      throw std::invalid_argument(who + ": the image of camera '" + cameras[c].name + "' must be " +
                                  std::to_string(cameras[c].width) + " x " + std::to_string(cameras[c].height) +
                                  " with 3 channels, found " + std::to_string(images[c].width) + " x " +
                                  std::to_string(images[c].height) + " with " + std::to_string(images[c].channels));
  for (std::size_t c = 0; c < masks.size(); ++c)
    if (masks.size() != cameras.size() || (!masks[c].empty() && (masks[c].channels != 1 || masks[c].width != cameras[c].width ||
                                                                 masks[c].height != cameras[c].height)))
      throw std::invalid_argument(who + ": expected no masks or one per camera with 1 channel and the camera's size, found " +
                                  std::to_string(masks.size()) + " masks, the one of camera " + std::to_string(c) + " being " +
                                  std::to_string(masks[c].width) + " x " + std::to_string(masks[c].height));
}

/// Paints the charts.
class TexturePainter {
public:
  TexturePainter(const FilmedFaces &filmed, const TextureOptions &options)
      : filmed_(filmed), options_(options), around_(filmed.mesh.vertices.rows()) {
    for (int f = 0; f < filmed.mesh.faces.rows(); ++f)
      for (int k = 0; k < 3; ++k)
        around_[filmed.mesh.faces(f, k)].push_back(f);
  }

  void paint(const detail::ChartLayout &layout, int f, Image &image) const {
    const std::vector<Layer> chosen = chosen_layers(f);
    std::optional<std::vector<Layer>> all;
    detail::for_texels(layout, f, [&](int x, int y, const Vector3d &at) {
      const Blend first = blended(chosen, f, at);
      Vector3f colour = first.sum;
      if (first.weight < 1) {
        if (!all)
          all = all_layers(f);
        colour += (1 - first.weight) * elsewhere(*all, f, at);
      }
      for (int c = 0; c < 3; ++c)
        image.at(x, y, c) = static_cast<std::uint8_t>(std::clamp(colour[c] + 0.5f, 0.0f, 255.0f));
    });
  }

private:
  /// Colours, each times its weight, and how far inside of what is seen the surest of them is.
  struct Blend {
    Vector3f sum = Vector3f::Zero();
    float weight = 0, inside = 0;

    void add(float share, const Vector3f &colour, float how_far) {
      sum += share * colour;
      weight += share;
      inside = std::max(inside, how_far);
    }
  };

  /// A face in a frame, how much it counts at the corners, and its levels there.
  struct Layer {
    const FaceView *view;
    Vector3d weights;
    Eigen::Matrix3f levels; ///< a column a corner
  };

  /// The frames that the faces around the corners take: between two, one goes over into the other.
  std::vector<Layer> chosen_layers(int f) const {
    std::vector<Layer> layers;
    for (int k = 0; k < 3; ++k)
      for (int g : around_[filmed_.mesh.faces(f, k)])
        if (const FaceView *view = filmed_.label[g] < 0 ? nullptr : filmed_.view(f, filmed_.label[g])) {
          auto at = std::find_if(layers.begin(), layers.end(), [&](const Layer &layer) { return layer.view == view; });
          if (at == layers.end())
            at = layers.insert(at, Layer{view, Vector3d::Zero(), levels(f, *view)});
          at->weights[k] += 1.0 / static_cast<double>(around_[filmed_.mesh.faces(f, k)].size());
        }
    return layers;
  }

  std::vector<Layer> all_layers(int f) const {
    std::vector<Layer> layers;
    for (const FaceView &view : filmed_.views[f]) {
      layers.push_back({&view, Vector3d::Zero(), levels(f, view)});
      for (int k = 0; k < 3; ++k)
        for (const std::vector<int> &around = around_[filmed_.mesh.faces(f, k)]; int g : around)
          if (const FaceView *other = filmed_.view(g, view.frame))
            layers.back().weights[k] += detail::worth(*other) / static_cast<double>(around.size());
    }
    return layers;
  }

  /// At the corners, the mean of the faces around that the frame shows.
  Eigen::Matrix3f levels(int f, const FaceView &view) const {
    Eigen::Matrix3f found;
    for (int k = 0; k < 3; ++k) {
      Vector3f sum = Vector3f::Zero();
      int count = 0;
      for (int g : around_[filmed_.mesh.faces(f, k)])
        if (const FaceView *other = filmed_.view(g, view.frame)) {
          sum += other->level;
          ++count;
        }
      found.col(k) = sum / static_cast<float>(std::max(count, 1));
    }
    return found;
  }

  Blend blended(const std::vector<Layer> &layers, int f, const Vector3d &at) const {
    Blend sum;
    for (const Layer &layer : layers) {
      const auto weight = static_cast<float>(layer.weights.dot(at));
      const Blend seen = weight > 0 ? seen_colour(*layer.view, f, at) : Blend{};
      if (seen.weight > 0)
        sum.add(weight * seen.inside, seen.sum / seen.weight + layer.levels * at.cast<float>(), seen.inside);
    }
    return sum;
  }

  /// What the chosen frames do not show: the mean of all, and towards the border of what any shows the colours of the faces.
  Vector3f elsewhere(const std::vector<Layer> &all, int f, const Vector3d &at) const {
    const Blend seen = blended(all, f, at);
    Vector3f colour = (1 - seen.inside) * between_faces(f, at);
    if (seen.weight > 0)
      colour += seen.inside / seen.weight * seen.sum;
    return colour;
  }

  /// The index in points_of_a_face() of the nearest.
  static int nearest_point(const Vector3d &at) {
    const int i = std::clamp(static_cast<int>(std::lround(detail::kAlong * at[0] - 1.0 / 3)), 0, detail::kAlong - 1);
    const int k = std::clamp(static_cast<int>(std::lround(detail::kAlong * at[1] - 1.0 / 3)), 0, detail::kAlong - 1 - i);
    return i * detail::kAlong - i * (i - 1) / 2 + k;
  }

  /// The cameras that see the point.
  Blend seen_colour(const FaceView &view, int f, const Vector3d &at) const {
    constexpr double kLeast = 1e-3; // beside a border a camera counts where no other is
    const detail::FilmedFrame &frame = filmed_.frames[view.frame];
    const Faces &faces = filmed_.mesh.faces;
    const Vector3d point = frame.point(faces, f, at), normal = frame.normal(faces, f, at);
    const int nearest = nearest_point(at);
    Blend found;
    for (const detail::SeenPoints &seen : view.seen) {
      if (!(seen.points >> nearest & 1))
        continue;
      const Camera &camera = filmed_.cameras[seen.camera];
      const detail::ImagePart &part = frame.parts[seen.camera];
      const double facing = std::max(normal.dot((camera.centre() - point).normalized()), options_.grazing);
      const double weight = detail::sight_weight(facing, camera.depth(point), camera, options_.facing_power),
                   inside = std::max(kLeast, frame.inside_at(faces, f, at, seen.camera));
      const Vector2d last(part.image.width - 1.001, part.image.height - 1.001);
      found.add(static_cast<float>(weight * inside),
                detail::bilinear(part.image, (camera.project(point) - part.origin).cwiseMax(0).cwiseMin(last)),
                static_cast<float>(inside));
    }
    if (found.weight > 0)
      found.sum = found.weight * detail::within_white(found.sum.cwiseProduct(frame.gain(faces, f, at)) / found.weight);
    return found;
  }

  /// The colours of the faces, smooth between them.
  Vector3f between_faces(int f, const Vector3d &at) const {
    Vector3f colour = Vector3f::Zero();
    for (int k = 0; k < 3; ++k) {
      const std::vector<int> &faces = around_[filmed_.mesh.faces(f, k)];
      for (int g : faces)
        colour += static_cast<float>(at[k] / static_cast<double>(faces.size())) * filmed_.colour[g];
    }
    return colour;
  }

  const FilmedFaces &filmed_;
  const TextureOptions &options_;
  std::vector<std::vector<int>> around_; ///< [V] faces
};

/// Share of the drawn area that some view shows.
double seen_share(const FilmedFaces &filmed, const std::vector<std::uint8_t> &valid) {
  const Eigen::VectorXd areas = face_areas(filmed.mesh.vertices, filmed.mesh.faces);
  double drawn = 0, covered = 0;
  for (Eigen::Index f = 0; f < areas.size(); ++f) {
    if (!valid.empty() && !valid[f])
      continue;
    unsigned seen = 0;
    for (const FaceView &view : filmed.views[f])
      for (const detail::SeenPoints &points : view.seen)
        seen |= points.points;
    drawn += areas[f];
    covered += areas[f] * std::popcount(seen) / detail::kPoints;
  }
  return drawn > 0 ? covered / drawn : 0;
}

/// As they stand in a frame.
Vertices vertices_of(const FilmedSurface &filmed, int frame, const Mesh &mesh) {
  Vertices vertices = filmed.vertices(frame);
  require_length("FilmedSurface", "vertices of frame " + std::to_string(frame), static_cast<std::size_t>(vertices.rows()),
                 mesh.vertices.rows());
  return vertices;
}

/// What the chosen frames show.
void look(FilmedFaces &seen, const std::vector<int> &frames, const std::vector<std::uint8_t> &valid, const FilmedSurface &filmed,
          const std::vector<SurfaceLabel> &labels, const TextureOptions &options, const Context &context) {
  std::shared_ptr<const detail::LabelColours> label_colours;
  for (std::size_t t = 0; t < frames.size(); ++t) {
    context.report_progress("texture", static_cast<double>(t) / static_cast<double>(frames.size() + 2));
    const Mesh posed{vertices_of(filmed, frames[t], seen.mesh), seen.mesh.faces};
    const FrameImages images = filmed.images(frames[t]);
    require_inputs("bake_texture", posed, valid, seen.cameras, images.images, images.masks);
    detail::SurfaceSights sights(posed, valid, seen.cameras, images.images, images.masks, options);
    label_colours = sights.keep_apart(labels, label_colours, context);
    detail::add_frame(seen, sights, posed.vertices, images.images, options, context);
  }
}

Image painted(const FilmedFaces &seen, const detail::ChartLayout &layout, const TextureOptions &options, const Context &context) {
  constexpr int kChunk = 2000;
  Image image(layout.size, layout.size, 3, 128);
  const TexturePainter painter(seen, options);
  const int faces = static_cast<int>(seen.mesh.faces.rows());
  for (int first = 0; first < faces; first += kChunk) {
    context.throw_if_cancelled();
    parallel_for(context, std::min(kChunk, faces - first), [&](int f) { painter.paint(layout, first + f, image); });
  }
  detail::fill_between_charts(layout, image);
  return image;
}

/// Texture and share seen.
std::pair<Image, double> baked_into(const detail::ChartLayout &layout, const Mesh &mesh, const std::vector<std::uint8_t> &valid,
                                    const CameraRig &cameras, const FilmedSurface &filmed,
                                    const std::vector<SurfaceLabel> &labels, const TextureOptions &options,
                                    const Context &context) {
  const std::size_t faces = layout.chart.size();
  FilmedFaces seen{mesh, cameras, {}, std::vector<std::vector<FaceView>>(faces), face_neighbours(mesh.faces), {}, {}, {}};
  look(seen, choose_texture_frames(mesh, valid, cameras, filmed, options, context), valid, filmed, labels, options, context);
  if (options.albedo)
    detail::divide_light(seen, context);
  detail::find_insides(seen, valid, context);
  detail::find_levels(seen, context);
  detail::choose_views(seen);
  Image image = painted(seen, layout, options, context);
  context.report_progress("texture", 1.0);
  return {std::move(image), seen_share(seen, valid)};
}

/// How much a colour (B G R) looks like the hidden body's, in light or in shadow: 1 = very, 0 = a shoe, a sock.
double likeness(const Vector3d &bgr, const Vector3d &skin) {
  constexpr double kChroma = 0.08, kLight = 1.0; // of the channels' shares, summed; of the logarithm of the brightness
  const double sum = bgr.sum() + 1, skin_sum = skin.sum() + 1;
  const double chroma = (bgr / sum - skin / skin_sum).cwiseAbs().sum() / kChroma, light = std::log(sum / skin_sum) / kLight;
  return std::exp(-chroma * chroma - light * light);
}

/// Skin goes over into the hidden body's colour towards the seam where the body goes on; what is darker there is in the
/// garment's shadow. Where the body is of the same surface, what is not like it (a stocking) goes on there and over into it.
/// `away` as of detail::beyond_free_edges().
void fade_into_hidden(const Character &c, const std::vector<double> &away, const detail::HiddenSkin &skin,
                      const detail::ChartLayout &layout, Image &image) {
  constexpr double kReach = 0.10, kWhole = 0.02; // m
  const std::vector<std::uint8_t> hidden = hidden_faces(c);
  std::vector<std::optional<detail::HiddenSkin::Here>> known(away.size()); // of vertices that were asked for
  for (int f = 0; f < c.high.faces.rows(); ++f) {
    const Eigen::Vector3i corners = c.high.faces.row(f);
    const bool is_skin = std::isfinite(std::max({away[corners[0]], away[corners[1]], away[corners[2]]}));
    if (!c.high_valid[f] || !(is_skin || hidden[f]))
      continue;
    Vector3d distances;
    Eigen::Matrix3d colours; // a column a corner
    for (int k = 0; k < 3; ++k) {
      std::optional<detail::HiddenSkin::Here> &here = known[corners[k]];
      if (!here)
        here = skin.at(c.high.vertices.row(corners[k]));
      distances[k] = std::min(here->distance, kReach);
      colours.col(k) = here->colour;
    }
    if (!hidden[f] && distances.minCoeff() == kReach)
      continue;
    detail::for_texels(layout, f, [&](int x, int y, const Vector3d &b) {
      Vector3d colour(image.at(x, y, 0), image.at(x, y, 1), image.at(x, y, 2));
      const Vector3d expected = colours * b;
      const double near = std::clamp((kReach - b.dot(distances)) / (kReach - kWhole), 0.0, 1.0);
      const double share = near * near * (3 - 2 * near), alike = likeness(colour, expected);
      colour += (hidden[f] ? 1 - share * (1 - alike) : share * alike) * (expected - colour);
      for (int k = 0; k < 3; ++k)
        image.at(x, y, k) = static_cast<std::uint8_t>(std::clamp(colour[k] + 0.5, 0.0, 255.0));
    });
  }
}

/// (FH) the garment's own faces, or those of cloth.
std::vector<SurfaceLabel> labels_of(const Character &c, const DisplaySurface &display) {
  std::vector<SurfaceLabel> labels(static_cast<std::size_t>(c.high.faces.rows()), SurfaceLabel::Body);
  if (c.garment_subdivisions >= 0) {
    std::fill(labels.begin() + detail::garment_part(c).skin_faces, labels.end(), SurfaceLabel::Garment);
    return labels;
  }
  const MatrixRM clothness = display.sample(c.segmentation.clothness);
  for (Eigen::Index f = 0; f < c.high.faces.rows(); ++f)
    if (clothness(c.high.faces.row(f), 0).mean() > 0.5)
      labels[f] = SurfaceLabel::Garment;
  return labels;
}

/// (F) how much of each face the cameras show: 1 = seen from in front.
std::vector<float> shown_shares(const Mesh &posed, const std::vector<std::uint8_t> &valid, const CameraRig &cameras) {
  const Eigen::VectorXd areas = face_areas(posed.vertices, posed.faces);
  std::vector<float> shares(static_cast<std::size_t>(posed.faces.rows()), 0);
  for (const Camera &camera : cameras) {
    const FaceBuffer buffer = rasterize(posed.vertices, posed.faces, camera, valid);
    std::vector<double> area(shares.size(), 0); // m^2, across the rays
    for (std::size_t i = 0; i < buffer.face.size(); ++i)
      if (buffer.face[i] >= 0)
        area[buffer.face[i]] += std::pow(buffer.depth[i] / camera.K(0, 0), 2);
    for (std::size_t f = 0; f < shares.size(); ++f)
      shares[f] = std::max(shares[f], static_cast<float>(std::min(1.0, area[f] / std::max(areas[f], 1e-12))));
  }
  return shares;
}

FilmedSurface one_frame(const Vertices &vertices, const std::vector<Image> &images, const std::vector<Image> &masks) {
  return {1, [&](int) { return vertices; }, [&](int) { return FrameImages{images, masks}; }};
}

} // namespace

std::vector<int> choose_texture_frames(const Mesh &mesh, const std::vector<std::uint8_t> &face_valid, const CameraRig &cameras,
                                       const FilmedSurface &filmed, const TextureOptions &options, const Context &context) {
  constexpr int kCandidates = 40;
  if (filmed.frame_count < 1)
    throw std::invalid_argument("choose_texture_frames: expected a frame or more, found " + std::to_string(filmed.frame_count));
  std::vector<int> frames{0}, candidates;
  if (options.frames == 1 || filmed.frame_count == 1)
    return frames;
  const int step = (filmed.frame_count + kCandidates - 1) / kCandidates;
  for (int frame = 0; frame < filmed.frame_count; frame += step)
    candidates.push_back(frame);
  std::vector<Eigen::ArrayXf> worths(candidates.size()); // [F]
  parallel_for(context, static_cast<int>(candidates.size()), [&](int i) {
    const std::vector<float> shares = shown_shares({vertices_of(filmed, candidates[i], mesh), mesh.faces}, face_valid, cameras);
    worths[i] = Eigen::Map<const Eigen::ArrayXf>(shares.data(), static_cast<Eigen::Index>(shares.size()))
                    .pow(static_cast<float>(options.facing_power));
  });
  const Eigen::ArrayXf areas = face_areas(mesh.vertices, mesh.faces).cast<float>();
  Eigen::ArrayXf sum = worths[0];
  std::vector<std::uint8_t> taken(candidates.size(), 0);
  taken[0] = 1;
  while (static_cast<int>(frames.size()) < std::min<int>(options.frames, static_cast<int>(candidates.size()))) {
    float most = -1;
    std::size_t best = 0;
    for (std::size_t i = 0; i < candidates.size(); ++i)
      if (const float worth = taken[i] ? -1 : (areas * (sum + worths[i]).sqrt()).sum(); worth > most) { // less for the second
        most = worth;
        best = i;
      }
    taken[best] = 1;
    sum += worths[best];
    frames.push_back(candidates[best]);
  }
  std::sort(frames.begin(), frames.end());
  return frames;
}

BakedTexture bake_texture(const Mesh &mesh, const std::vector<std::uint8_t> &face_valid, const CameraRig &cameras,
                          const FilmedSurface &filmed, const std::vector<SurfaceLabel> &face_labels,
                          const TextureOptions &options, const Context &context) {
  options.validate();
  require_usable(mesh, "bake_texture: mesh");
  if (!face_valid.empty())
    require_length("bake_texture", "face_valid", face_valid.size(), mesh.faces.rows());
  if (!face_labels.empty())
    require_length("bake_texture", "face_labels", face_labels.size(), mesh.faces.rows());
  detail::ChartLayout layout = detail::lay_out_charts(mesh, face_valid, options.size);
  auto [image, share] = baked_into(layout, mesh, face_valid, cameras, filmed, face_labels, options, context);
  return {std::move(layout.texcoords), std::move(image), share};
}

BakedTexture bake_texture(const Mesh &mesh, const std::vector<std::uint8_t> &face_valid, const CameraRig &cameras,
                          const std::vector<Image> &images, const std::vector<Image> &masks,
                          const std::vector<SurfaceLabel> &face_labels, const TextureOptions &options, const Context &context) {
  return bake_texture(mesh, face_valid, cameras, one_frame(mesh.vertices, images, masks), face_labels, options, context);
}

Vertices sample_colours(const Mesh &mesh, const std::vector<std::uint8_t> &face_valid, const CameraRig &cameras,
                        const std::vector<Image> &images, const std::vector<Image> &masks, const TextureOptions &options,
                        const Context &context) {
  options.validate();
  require_inputs("sample_colours", mesh, face_valid, cameras, images, masks);
  const detail::SurfaceSights sights(mesh, face_valid, cameras, images, masks, options);
  const int faces = static_cast<int>(mesh.faces.rows());
  Vertices colours = Vertices::Constant(detail::kPoints * faces, 3, std::numeric_limits<double>::quiet_NaN());
  parallel_for(context, faces, [&](int f) {
    int row = detail::kPoints * f;
    for (const Vector3d &at : detail::points_of_a_face()) {
      Vector3f colour;
      if (sights.drawn(f) && sights.colour_at(f, at, colour) > 0)
        colours.row(row) = colour.cast<double>().transpose();
      ++row;
    }
  });
  return colours;
}

double texture_character(Character &character, const FilmedSurface &filmed, const CameraRig &cameras,
                         const TextureOptions &options, const Context &context) {
  options.validate();
  const DisplaySurface display(character);
  const detail::ChartLayout layout = detail::lay_out_charts(character.high, character.high_valid, options.size);
  const FilmedSurface drawn{filmed.frame_count, [&](int frame) { return display.apply(filmed.vertices(frame)); }, filmed.images};
  auto [image, share] =
      baked_into(layout, character.high, character.high_valid, cameras, drawn, labels_of(character, display), options, context);
  const std::vector<double> away = detail::beyond_free_edges(character);
  const detail::HiddenSkin skin(character, away, layout.texcoords, image);
  if (skin.is_known() && options.albedo) {
    fade_into_hidden(character, away, skin, layout, image);
    detail::fill_between_charts(layout, image); // their borders, too
  }
  character.texcoords = layout.texcoords;
  character.texture = encode_jpeg(image);
  return share;
}

double texture_character(Character &character, const Vertices &surface, const CameraRig &cameras,
                         const std::vector<Image> &images, const std::vector<Image> &masks, const TextureOptions &options,
                         const Context &context) {
  return texture_character(character, one_frame(surface, images, masks), cameras, options, context);
}

} // namespace doublet
