// FCL's geometries and poses, taken over: the distances of both libraries, side by side.
//
// usage: fcl [QUERIES]
//
// Pairs of FCL's geometries at random poses. The bounds of lin-canny are proven, so a distance of FCL that is far outside of
// them is wrong. Exit code 0 if nearly all distances agree.
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <random>
#include <stdexcept>
#include <vector>

#include <fcl/fcl.h>

#include "lin_canny.hpp"

using namespace lin_canny;

// A pose of FCL: a translation and a rotation matrix.
static lc_pose taken(const fcl::Transform3d &pose) {
  const fcl::Vector3d t = pose.translation();
  const fcl::Quaterniond q = fcl::Quaterniond(pose.linear()).normalized();
  return {{t.x(), t.y(), t.z()}, {q.x(), q.y(), q.z(), q.w()}};
}

static std::vector<Point> points(const fcl::Vector3d *xyz, std::size_t count) {
  std::vector<Point> all;
  for (std::size_t k = 0; k < count; ++k) all.push_back({xyz[k].x(), xyz[k].y(), xyz[k].z()});
  return all;
}

// A geometry of FCL: lengths are halves here.
static Geometry taken(const fcl::CollisionGeometryd &geometry) {
  switch (geometry.getNodeType()) {
    case fcl::GEOM_BOX: {
      const auto &box = static_cast<const fcl::Boxd &>(geometry);
      return Geometry::box(box.side.x() / 2, box.side.y() / 2, box.side.z() / 2);
    }
    case fcl::GEOM_SPHERE: return Geometry::ball(static_cast<const fcl::Sphered &>(geometry).radius);
    case fcl::GEOM_CAPSULE: {
      const auto &capsule = static_cast<const fcl::Capsuled &>(geometry);
      return Geometry::capsule(capsule.lz / 2, capsule.radius);
    }
    case fcl::GEOM_CYLINDER: {
      const auto &cylinder = static_cast<const fcl::Cylinderd &>(geometry);
      return Geometry::cylinder(cylinder.lz / 2, cylinder.radius);
    }
    case fcl::GEOM_CONE: {
      const auto &cone = static_cast<const fcl::Coned &>(geometry);
      return Geometry::cone(cone.lz / 2, cone.radius);
    }
    case fcl::GEOM_ELLIPSOID: {
      const auto &ellipsoid = static_cast<const fcl::Ellipsoidd &>(geometry);
      return Geometry::ellipsoid(ellipsoid.radii.x(), ellipsoid.radii.y(), ellipsoid.radii.z());
    }
    case fcl::GEOM_HALFSPACE: {
      const auto &space = static_cast<const fcl::Halfspaced &>(geometry);
      return Geometry::half_space({space.n.x(), space.n.y(), space.n.z()}, space.d);
    }
    case fcl::GEOM_CONVEX: {
      const auto &convex = static_cast<const fcl::Convexd &>(geometry);
      return Geometry::hull(points(convex.getVertices().data(), convex.getVertices().size()));
    }
    case fcl::BV_OBBRSS: {
      const auto &mesh = static_cast<const fcl::BVHModel<fcl::OBBRSSd> &>(geometry);
      std::vector<Triangle> triangles;
      for (int k = 0; k < mesh.num_tris; ++k) {
        const fcl::Triangle &t = mesh.tri_indices[k];
        triangles.push_back({static_cast<std::uint32_t>(t[0]), static_cast<std::uint32_t>(t[1]),
                             static_cast<std::uint32_t>(t[2])});
      }
      return Geometry::mesh(points(mesh.vertices, static_cast<std::size_t>(mesh.num_vertices)), triangles);
    }
    default: throw std::invalid_argument("this kind of FCL's geometries is not taken over");
  }
}

static std::shared_ptr<fcl::CollisionGeometryd> tetrahedron() {
  auto mesh = std::make_shared<fcl::BVHModel<fcl::OBBRSSd>>();
  const std::vector<fcl::Vector3d> vertices{{-1, -1, -1}, {1, -1, -1}, {0, 1, -1}, {0, 0, 1}};
  std::vector<fcl::Triangle> triangles;
  triangles.emplace_back(0, 2, 1), triangles.emplace_back(0, 1, 3), triangles.emplace_back(1, 2, 3);
  triangles.emplace_back(2, 0, 3);
  mesh->beginModel();
  mesh->addSubModel(vertices, triangles);
  mesh->endModel();
  return mesh;
}

static double seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

static int run(int queries) {
  struct Named {
    const char *name;
    std::shared_ptr<fcl::CollisionGeometryd> geometry;
  };
  const std::vector<Named> all{{"box", std::make_shared<fcl::Boxd>(1, 2, 3)},
                               {"sphere", std::make_shared<fcl::Sphered>(0.5)},
                               {"capsule", std::make_shared<fcl::Capsuled>(0.5, 2)},
                               {"cylinder", std::make_shared<fcl::Cylinderd>(0.5, 2)},
                               {"cone", std::make_shared<fcl::Coned>(0.5, 2)},
                               {"ellipsoid", std::make_shared<fcl::Ellipsoidd>(0.5, 1, 1.5)},
                               {"mesh", tetrahedron()}};
  std::mt19937_64 random(1);
  std::normal_distribution<> normal;
  std::printf("| pair | queries apart | FCL, us | lin-canny, us | FCL off by 1e-6 | by 1e-3 | most |\n");
  std::printf("|---|---:|---:|---:|---:|---:|---:|\n");
  long asked = 0, wrong = 0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    for (std::size_t j = i; j < all.size(); ++j) {
      const Geometry a = taken(*all[i].geometry), b = taken(*all[j].geometry);
      Pair pair(a, b);
      long apart = 0, off = 0, far = 0;
      double of_fcl = 0, ours = 0, most = 0;
      for (int k = 0; k < queries; ++k) {
        fcl::Transform3d there = fcl::Transform3d::Identity();
        there.linear() = fcl::Quaterniond(normal(random), normal(random), normal(random), normal(random))
                             .normalized()
                             .toRotationMatrix();
        there.translation() = 3 * fcl::Vector3d(normal(random), normal(random), normal(random));
        const double t0 = seconds();
        const lc_answer answer = pair.closest(identity, taken(there));
        const double t1 = seconds();
        if (!(answer.lower > 1e-3)) continue; /* FCL returns -1 for overlaps */
        fcl::DistanceRequestd request(true);
        fcl::DistanceResultd result;
        const double t2 = seconds();
        fcl::distance(all[i].geometry.get(), fcl::Transform3d::Identity(), all[j].geometry.get(), there, request, result);
        of_fcl += seconds() - t2;
        ours += t1 - t0;
        const double d = result.min_distance, error = std::fmax(answer.lower - d, d - answer.upper);
        ++apart;
        off += error > 1e-6;
        far += error > 1e-3;
        most = std::fmax(most, error);
      }
      std::printf("| %s and %s | %ld | %.2f | %.2f | %ld | %ld | %.1e |\n", all[i].name, all[j].name, apart,
                  1e6 * of_fcl / static_cast<double>(apart), 1e6 * ours / static_cast<double>(apart), off, far, most);
      asked += apart;
      wrong += far;
    }
  }
  std::printf("\n%ld queries; %ld distances of FCL are more than 1e-3 outside of the proven bounds\n", asked, wrong);
  return 20 * wrong > asked;
}

int main(int argc, char **argv) {
  const int queries = argc > 1 ? std::atoi(argv[1]) : 200;
  if (argc > 2 || queries < 1) return std::printf("usage: fcl [QUERIES]\n"), 2;
  try {
    return run(queries);
  } catch (const std::exception &e) {
    return std::printf("error: %s\n", e.what()), 1;
  }
}
