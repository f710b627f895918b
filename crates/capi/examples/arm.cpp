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
  other[1] = 0.4;
  const lc_near near = checker.clearance(home);
  std::printf("closest at home: %s and %s, %.6f in [%.12f, %.12f]\n", checker.name(near.a).c_str(),
              checker.name(near.b).c_str(), near.distance, near.lower, near.upper);

  const lc_verdict verdict = checker.certify(home, other);
  std::printf("home to other: %s, proven up to %.3f\n", verdict.state == LC_FREE ? "free" : "not free", verdict.free_until);

  // A ball where the gripper passes halfway: the verdict names the pair and brackets the time.
  std::vector<double> middle = home;
  middle[1] = 0.2;
  const lc_pose hand = checker.pose(checker.find("gripper").at(0), middle);
  const lc_world_body ball = checker.add_obstacle("ball", Geometry::ball(0.02), hand);
  const lc_verdict blocked = checker.certify(home, other);
  const bool was_blocked = blocked.state == LC_BLOCKED && blocked.b.id == ball.id && blocked.free_until < blocked.contact_at;
  if (was_blocked) {
    std::printf("with a ball on the way: %s meets %s between %.9f and %.9f\n", checker.name(blocked.a).c_str(),
                checker.name(blocked.b).c_str(), blocked.free_until, blocked.contact_at);
  }
  checker.remove(ball);

  // A path of segments that are proven free, and the same path certified again.
  lc_plan_options options{};
  options.shorten = 100;
  const std::vector<double> path = checker.plan(home, other, options);
  const bool is_proven = !path.empty() && checker.certify_path(path).state == LC_FREE;
  std::printf("path of %zu configurations, %s; %llu distance queries\n", path.size() / n,
              is_proven ? "proven free" : "not proven", static_cast<unsigned long long>(checker.work().queries));

  try {
    checker.find("no such link");
    return 1;
  } catch (const Error &e) {
    std::printf("refused: %s\n", e.what());
  }
  return near.lower > 0 && was_blocked && is_proven ? 0 : 1;
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
