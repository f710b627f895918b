// OMPL with proven motions: a state validity checker and a motion validator on a checker of lin-canny.
//
// usage: ompl FOLDER [RUNS]; FOLDER is that of six_axis.urdf.
//
// RRT-Connect plans for the six-axis arm in its cell, from bin to bin and between random configurations: with the proven
// motion validator, and with OMPL's discrete one at its default resolution and at finer ones. All of them ask the same
// validity checker of states. An edge is wrong if its validator accepted it and a pair of bodies is proven in contact on it.
// Exit code 0 if no path of the proven validator is wrong.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <memory>
#include <mutex>
#include <random>
#include <string>
#include <vector>

#include <ompl/base/DiscreteMotionValidator.h>
#include <ompl/base/MotionValidator.h>
#include <ompl/base/SpaceInformation.h>
#include <ompl/base/StateValidityChecker.h>
#include <ompl/base/spaces/RealVectorStateSpace.h>
#include <ompl/geometric/PathGeometric.h>
#include <ompl/geometric/planners/rrt/RRTConnect.h>
#include <ompl/util/Console.h>
#include <ompl/util/RandomNumbers.h>

#include "lin_canny.hpp"

namespace ob = ompl::base;
namespace og = ompl::geometric;
using namespace lin_canny;

// Lends checkers to threads. OMPL calls validators in several threads, and a checker serves one call at a time.
class Pool {
 public:
  explicit Pool(Checker first) : first_(std::move(first)) {}

  template <class Call>
  auto use(Call call) {
    Checker checker = take();
    struct Back {
      Pool &pool;
      Checker &checker;
      ~Back() { pool.give(std::move(checker)); }
    } back{*this, checker};
    return call(checker);
  }

 private:
  Checker take() {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (idle_.empty()) return first_.copy();
    Checker checker = std::move(idle_.back());
    idle_.pop_back();
    return checker;
  }
  void give(Checker checker) {
    const std::lock_guard<std::mutex> lock(mutex_);
    idle_.push_back(std::move(checker));
  }

  std::mutex mutex_;
  Checker first_;
  std::vector<Checker> idle_;
};

static Span<double> values(const ob::SpaceInformation *si, const ob::State *state) {
  return {state->as<ob::RealVectorStateSpace::StateType>()->values, si->getStateDimension()};
}

// States are valid if all pairs of bodies are proven to keep their margins. A checker throws at a state out of bounds.
class Validity : public ob::StateValidityChecker {
 public:
  Validity(const ob::SpaceInformationPtr &si, Pool &pool) : ob::StateValidityChecker(si), pool_(pool) {}
  bool isValid(const ob::State *s) const override {
    return si_->satisfiesBounds(s) && pool_.use([&](Checker &c) { return c.is_free(values(si_, s)); });
  }
  double clearance(const ob::State *s) const override {
    return pool_.use([&](Checker &c) { return c.clearance(values(si_, s)).distance; });
  }

 private:
  Pool &pool_;
};

// Motions are valid if they are proven free over their whole length: there is no resolution to choose.
class Proven : public ob::MotionValidator {
 public:
  Proven(const ob::SpaceInformationPtr &si, Pool &pool) : ob::MotionValidator(si), pool_(pool) {}
  bool checkMotion(const ob::State *a, const ob::State *b) const override {
    const bool is_free = si_->satisfiesBounds(b) && verdict(a, b).state == LC_FREE;
    ++(is_free ? valid_ : invalid_);
    return is_free;
  }
  // `last` gets the last state that is proven free, and its fraction of the way.
  bool checkMotion(const ob::State *a, const ob::State *b, std::pair<ob::State *, double> &last) const override {
    double safe = 0;
    if (si_->satisfiesBounds(b)) {
      const lc_verdict found = verdict(a, b);
      if (found.state == LC_FREE) return ++valid_, true;
      safe = found.free_until;
    }
    last.second = safe;
    if (last.first) si_->getStateSpace()->interpolate(a, b, safe, last.first);
    return ++invalid_, false;
  }

 private:
  lc_verdict verdict(const ob::State *a, const ob::State *b) const {
    return pool_.use([&](Checker &c) { return c.certify(values(si_, a), values(si_, b)); });
  }
  Pool &pool_;
};

struct Motion {
  std::vector<double> from, to;
};

static Motion motion_of(Span<double> from, Span<double> to) {
  return {std::vector<double>(from.begin(), from.end()), std::vector<double>(to.begin(), to.end())};
}

// Another validator, whose accepted motions are kept for the count.
class Recorded : public ob::MotionValidator {
 public:
  Recorded(const ob::SpaceInformationPtr &si, ob::MotionValidatorPtr inner)
      : ob::MotionValidator(si), inner_(std::move(inner)) {}
  bool checkMotion(const ob::State *a, const ob::State *b) const override {
    return kept(inner_->checkMotion(a, b), a, b);
  }
  bool checkMotion(const ob::State *a, const ob::State *b, std::pair<ob::State *, double> &last) const override {
    return kept(inner_->checkMotion(a, b, last), a, b);
  }
  const std::vector<Motion> &accepted() const { return accepted_; }

 private:
  bool kept(bool is_valid, const ob::State *a, const ob::State *b) const {
    ++(is_valid ? valid_ : invalid_);
    if (is_valid) accepted_.push_back(motion_of(values(si_, a), values(si_, b)));
    return is_valid;
  }
  ob::MotionValidatorPtr inner_;
  mutable std::vector<Motion> accepted_;
};

// Joints that bring the tip of the gripper to a position, with the gripper pointing down: two links in a vertical plane.
static std::vector<double> reach(double x, double y, double z) {
  const double shoulder = 0.32, upper = 0.45, fore = 0.55, hand = 0.235, pi = std::acos(-1.0);
  const double out = std::hypot(x, y), up = z + hand - shoulder;
  const double cosine = (out * out + up * up - upper * upper - fore * fore) / (2 * upper * fore);
  const double elbow = std::acos(std::min(1.0, std::max(-1.0, cosine)));
  const double lift = std::atan2(out, up) - std::atan2(fore * std::sin(elbow), upper + fore * std::cos(elbow));
  return {std::atan2(y, x), lift, elbow, 0, pi - lift - elbow, 0};
}

// As deep in a bin as the gripper is free.
static std::vector<double> in_bin(Checker &checker, double x, double y) {
  for (double z = 0.32;; z += 0.01) {
    std::vector<double> q = reach(x, y, z);
    if (z > 0.8 || checker.is_free(q)) return q;
  }
}

struct Counts {
  long runs = 0, solved = 0, checks = 0, accepted = 0, wrong = 0, edges = 0, wrong_edges = 0, wrong_paths = 0, seen = 0;
  double deepest = 0;
  std::vector<double> times;
};

// Returns whether a pair is proven in contact on a motion. Another predicate, about one configuration, must say the same.
static bool is_wrong(Checker &checker, const Motion &motion, Counts &counts) {
  const lc_verdict found = checker.certify(motion.from, motion.to);
  if (found.state != LC_BLOCKED) return false;
  std::vector<double> q(motion.from.size());
  for (std::size_t k = 0; k < q.size(); ++k) q[k] = motion.from[k] + found.contact_at * (motion.to[k] - motion.from[k]);
  counts.seen += !checker.is_free(q);
  return true;
}

// The greatest depth at places of a motion, as a length.
static double depth(Checker &checker, const Motion &motion) {
  double least = 0;
  std::vector<double> q(motion.from.size());
  for (int i = 0; i <= 500; ++i) {
    for (std::size_t k = 0; k < q.size(); ++k) q[k] = motion.from[k] + i / 500.0 * (motion.to[k] - motion.from[k]);
    least = std::min(least, checker.clearance(q).distance);
  }
  return -least;
}

// Plans once; a resolution of zero is the proven validator.
static void plan(const ob::StateSpacePtr &space, Pool &pool, Checker &judge, double resolution,
                 const std::vector<double> &from, const std::vector<double> &to, Counts &counts) {
  auto si = std::make_shared<ob::SpaceInformation>(space);
  si->setStateValidityChecker(std::make_shared<Validity>(si, pool));
  ob::MotionValidatorPtr inner;
  if (resolution == 0) {
    inner = std::make_shared<Proven>(si, pool);
  } else {
    si->setStateValidityCheckingResolution(resolution);
    inner = std::make_shared<ob::DiscreteMotionValidator>(si);
  }
  auto recorded = std::make_shared<Recorded>(si, inner);
  si->setMotionValidator(recorded);
  si->setup();
  ob::ScopedState<> start(space), goal(space);
  for (std::size_t k = 0; k < from.size(); ++k) start[k] = from[k], goal[k] = to[k];
  auto problem = std::make_shared<ob::ProblemDefinition>(si);
  problem->setStartAndGoalStates(start, goal);
  og::RRTConnect planner(si);
  planner.setProblemDefinition(problem);
  planner.setup();

  const std::clock_t before = std::clock();
  const ob::PlannerStatus status = planner.solve(ob::timedPlannerTerminationCondition(20.0));
  counts.times.push_back(1e3 * static_cast<double>(std::clock() - before) / CLOCKS_PER_SEC);
  ++counts.runs;
  counts.checks += recorded->getValidMotionCount() + recorded->getInvalidMotionCount();
  for (const Motion &motion : recorded->accepted()) {
    ++counts.accepted;
    counts.wrong += is_wrong(judge, motion, counts);
  }
  if (status != ob::PlannerStatus::EXACT_SOLUTION) return;
  ++counts.solved;
  const auto &path = static_cast<const og::PathGeometric &>(*problem->getSolutionPath());
  bool is_path_wrong = false;
  for (std::size_t k = 0; k + 1 < path.getStateCount(); ++k) {
    const Motion motion = motion_of(values(si.get(), path.getState(k)), values(si.get(), path.getState(k + 1)));
    Counts ignored;
    const bool is_edge_wrong = is_wrong(judge, motion, ignored);
    ++counts.edges;
    counts.wrong_edges += is_edge_wrong;
    is_path_wrong |= is_edge_wrong;
    if (is_edge_wrong) counts.deepest = std::max(counts.deepest, depth(judge, motion));
  }
  counts.wrong_paths += is_path_wrong;
}

static int run(const std::string &folder, int runs) {
  const std::string robot = folder + "/six_axis.urdf", srdf = folder + "/six_axis.srdf", cell = folder + "/six_axis_cell.json";
  Checker judge = Checker::load(robot.c_str(), srdf.c_str(), cell.c_str());
  Pool pool(judge.copy());
  const auto limits = judge.limits();
  const auto n = static_cast<unsigned>(judge.coordinates());
  auto space = std::make_shared<ob::RealVectorStateSpace>(n);
  ob::RealVectorBounds bounds(n);
  bounds.low = limits[0];
  bounds.high = limits[1];
  space->setBounds(bounds);

  // Problems: bin to bin, and pairs of random free configurations.
  std::mt19937_64 random(1);
  const auto free_state = [&] {
    std::vector<double> q(n);
    do {
      for (unsigned k = 0; k < n; ++k) q[k] = std::uniform_real_distribution<>(limits[0][k], limits[1][k])(random);
    } while (!judge.is_free(q));
    return q;
  };
  const std::vector<double> bin_a = in_bin(judge, 0.65, 0.35), bin_b = in_bin(judge, 0.65, -0.3);
  if (!judge.is_free(bin_a) || !judge.is_free(bin_b)) return std::printf("the gripper fits into no bin\n"), 1;
  std::vector<Motion> pairs;
  for (int k = 0; k < runs; ++k) {
    std::vector<double> from = free_state();
    pairs.push_back({std::move(from), free_state()});
  }
  std::printf("six-axis cell, RRT-Connect, %d runs of each kind; OMPL's default resolution is 0.01\n\n", runs);
  std::printf("| problem | validator | solved | ms a run, mean | median | motions tested a run | accepted edges, wrong of | "
              "edges of paths, wrong of | paths, wrong | deepest, mm |\n|---|---|---:|---:|---:|---:|---:|---:|---:|---:|\n");
  long wrong_proven = 0, unseen = 0;
  for (const bool is_bins : {true, false}) {
    for (const double resolution : {0.0, 0.01, 0.003, 0.001}) {
      Counts counts;
      for (int k = 0; k < runs; ++k) {
        const Motion &pair = pairs[static_cast<std::size_t>(k)];
        plan(space, pool, judge, resolution, is_bins ? bin_a : pair.from, is_bins ? bin_b : pair.to, counts);
      }
      double sum = 0;
      for (double time : counts.times) sum += time;
      std::sort(counts.times.begin(), counts.times.end());
      char name[32] = "proven";
      if (resolution > 0) std::snprintf(name, sizeof name, "discrete, %g", resolution);
      std::printf("| %s | %s | %ld of %ld | %.2f | %.2f | %.0f | %ld of %ld | %ld of %ld | %ld of %ld | %.1f |\n",
                  is_bins ? "bin to bin" : "random pairs", name, counts.solved, counts.runs,
                  sum / static_cast<double>(counts.runs), counts.times[counts.times.size() / 2],
                  static_cast<double>(counts.checks) / static_cast<double>(counts.runs), counts.wrong, counts.accepted,
                  counts.wrong_edges, counts.edges, counts.wrong_paths, counts.solved, 1e3 * counts.deepest);
      if (resolution == 0) wrong_proven += counts.wrong + counts.wrong_edges;
      unseen += counts.wrong - counts.seen;
    }
  }
  std::printf("\nWrong edges that the predicate of one configuration does not confirm: %ld\n", unseen);
  return wrong_proven != 0 || unseen != 0;
}

int main(int argc, char **argv) {
  const int runs = argc > 2 ? std::atoi(argv[2]) : 10;
  if (argc < 2 || argc > 3 || runs < 1) return std::printf("usage: ompl FOLDER [RUNS], the folder of six_axis.urdf\n"), 2;
  ompl::msg::setLogLevel(ompl::msg::LOG_ERROR);
  ompl::RNG::setSeed(1);
  try {
    return run(argv[1], runs);
  } catch (const std::exception &e) {
    return std::printf("error: %s\n", e.what()), 1;
  }
}
