// An arm that is certified: a robot and its cell from files, clearances, a motion proven free or blocked, a path.
#include <cstdio>
#include <string>
#include <vector>

#include "lin_canny.hpp"

using namespace lin_canny;

static int run(const std::string &folder) {
  const std::string robot = folder + "/six_axis.urdf", srdf = folder + "/six_axis.srdf", cell = folder + "/six_axis_cell.json";
  Checker checker = Checker::load(robot.c_str(), srdf.c_str(), cell.c_str());
  const std::size_t n = checker.coordinates();
  std::printf("%zu coordinates, the first is %s\n", n, checker.coordinate_name(0).c_str());

  std::vector<double> home(n, 0.0), other(n, 0.0);
  other[0] = 1.0;
  const lc_near near = checker.clearance(home.data());
  std::printf("closest at home: %s and %s, %.6f in [%.12f, %.12f]\n", checker.name(near.a).c_str(),
              checker.name(near.b).c_str(), near.distance, near.lower, near.upper);

  const lc_verdict verdict = checker.certify(home.data(), other.data());
  std::printf("home to other: %s, proven up to %.3f\n", verdict.state == LC_FREE ? "free" : "not free", verdict.safe);

  // A wall in the way: the verdict names the pair and brackets the time.
  const Geometry wall = Geometry::box(0.05, 2, 2);
  const lc_world_body added = checker.add_obstacle("wall", wall, at(5, 0, 0));
  bool was_blocked = false;
  for (double x = 3; x > 0.2 && !was_blocked; x -= 0.1) {
    checker.move_obstacle(added, at(x, 0, 0));
    if (!checker.is_free(home.data())) break;
    const lc_verdict found = checker.certify(home.data(), other.data());
    if (found.state == LC_BLOCKED) {
      was_blocked = true;
      std::printf("wall at %.1f: %s meets %s between %.9f and %.9f\n", x, checker.name(found.a).c_str(),
                  checker.name(found.b).c_str(), found.safe, found.hit);
    }
  }
  checker.remove(added);

  // A path of segments that are proven free, and the same path certified again.
  lc_plan_options options{};
  options.shorten = 100;
  const std::vector<double> path = checker.plan(home.data(), other.data(), options);
  const bool is_proven = !path.empty() && checker.certify_path(path).state == LC_FREE;
  std::printf("path of %zu configurations, %s; %llu distance queries\n", path.size() / n,
              is_proven ? "proven free" : "not proven", static_cast<unsigned long long>(checker.work().queries));

  try {
    checker.find("no such link");
    return 1;
  } catch (const Error &e) {
    std::printf("refused: %s\n", e.what());
  }
  return near.lower > 0 && is_proven ? 0 : 1;
}

int main(int argc, char **argv) {
  if (argc != 2) return std::printf("usage: arm FOLDER, that of six_axis.urdf\n"), 2;
  int wrong = 1;
  try {
    wrong = run(argv[1]);
  } catch (const std::exception &e) {
    std::printf("error: %s\n", e.what());
  }
  return wrong || lc_live() != 0;
}
