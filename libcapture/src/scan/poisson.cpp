#include "poisson.h"

#include "doublet/core/error.h"

#define MK_WARN(...) ((void)0) // which the library would print to stderr, with paths of its sources
#include <PreProcessor.h>      // first: the others ask what it defines

#include <Reconstructors.h>

namespace doublet::detail {
namespace {

namespace recon = PoissonRecon::Reconstructor;
using Real = float; // coordinates within a cube of 1: what the octree's depth can tell apart
using Point = PoissonRecon::Point<Real, 3>;
using Corners = std::vector<PoissonRecon::node_index_type>;

struct Samples : recon::InputOrientedSampleStream<Real, 3> {
  std::vector<Point> points, normals;
  std::size_t at = 0;

  void add(const Eigen::RowVector3d &point, const Eigen::RowVector3d &normal) {
    points.emplace_back(Real(point[0]), Real(point[1]), Real(point[2]));
    normals.emplace_back(Real(normal[0]), Real(normal[1]), Real(normal[2]));
  }
  void reset() override { at = 0; }
  bool read(Point &point, Point &normal) override {
    if (at == points.size())
      return false;
    point = points[at];
    normal = normals[at++];
    return true;
  }
};

struct SurfaceVertices : recon::OutputLevelSetVertexStream<Real, 3> {
  std::vector<Eigen::RowVector3d> points;
  std::vector<double> depths;

  std::size_t size() const override { return points.size(); }
  std::size_t write(const Point &point, const Point &, const Real &depth) override {
    points.emplace_back(point[0], point[1], point[2]);
    depths.push_back(depth);
    return points.size() - 1;
  }
};

struct SurfaceFaces : recon::OutputFaceStream<2> {
  std::vector<Eigen::RowVector3i> faces;

  std::size_t size() const override { return faces.size(); }
  std::size_t write(const Corners &corners) override {
    for (std::size_t k = 2; k < corners.size(); ++k)
      faces.emplace_back(int(corners[0]), int(corners[k - 1]), int(corners[k]));
    return faces.size() - 1;
  }
};

/// The library's own values but for the depths: a cube 1.1 times as large as the scan, one sample and a half in a cell, the
/// scan's points as a screen of weight 2.
PoissonSurface reconstruct(Samples &samples, int depth) {
  using Method = recon::Poisson;
  using Basis = PoissonRecon::IsotropicUIntPack<
      3, PoissonRecon::FEMDegreeAndBType<Method::DefaultFEMDegree, Method::DefaultFEMBoundary>::Signature>;
  recon::ProfilerMS = 0; // no thread that watches memory
  Method::SolutionParameters<Real> solution;
  solution.depth = static_cast<unsigned>(depth);
  solution.baseDepth = 0; // from the whole cube on; from 32 cells a side, the default, wide gaps are bridged 2 cm elsewhere
  recon::LevelSetExtractionParameters extraction;
  extraction.outputDensity = true;
  const std::unique_ptr<recon::Implicit<Real, 3, Basis>> surface(Method::Solver<Real, 3, Basis>::Solve(samples, solution));
  SurfaceVertices vertices;
  SurfaceFaces faces;
  surface->extractLevelSet(vertices, faces, extraction);

  PoissonSurface out;
  out.mesh.vertices.resize(static_cast<Eigen::Index>(vertices.points.size()), 3);
  for (std::size_t v = 0; v < vertices.points.size(); ++v)
    out.mesh.vertices.row(static_cast<Eigen::Index>(v)) = vertices.points[v];
  out.mesh.faces.resize(static_cast<Eigen::Index>(faces.faces.size()), 3);
  for (std::size_t f = 0; f < faces.faces.size(); ++f)
    out.mesh.faces.row(static_cast<Eigen::Index>(f)) = faces.faces[f];
  out.density = Eigen::Map<const Eigen::VectorXd>(vertices.depths.data(), static_cast<Eigen::Index>(vertices.depths.size()));
  return out;
}

} // namespace

PoissonSurface poisson_surface(const Mesh &scan, int depth) {
  return poisson_surface(scan.vertices, vertex_normals(scan.vertices, scan.faces), depth);
}

PoissonSurface poisson_surface(const Vertices &points, const Vertices &normals, int depth) {
  Samples samples;
  for (Eigen::Index v = 0; v < points.rows(); ++v)
    if (normals.row(v).squaredNorm() > 0.5) // a vertex without a face has no normal
      samples.add(points.row(v), normals.row(v));
  if (samples.points.size() < 4)
    throw Error("scan: expected triangles with an area, found only degenerate ones");
  try {
    return reconstruct(samples, depth);
  } catch (const std::exception &e) {
    throw Error(std::string("scan: the Poisson reconstruction failed (") + e.what() + ")");
  }
}

} // namespace doublet::detail
