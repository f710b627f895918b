//! RRT-Connect of the crate `oxmpl` with a checker at fixed steps: the rival of the searches of
//! `plan`.

use std::cell::RefCell;
use std::sync::Arc;
use std::time::Duration;

use lin_canny_plan::ConfigurationSpace;
use oxmpl::base::error::StateSamplingError;
use oxmpl::base::goal::{Goal, GoalRegion, GoalSampleableRegion};
use oxmpl::base::planner::{Planner, PlannerConfig};
use oxmpl::base::problem_definition::ProblemDefinition;
use oxmpl::base::space::{SE3StateSpace, StateSpace};
use oxmpl::base::state::{SE3State, SO3State};
use oxmpl::base::validity::StateValidityChecker;
use oxmpl::geometric::RRTConnect;

/// Longest extension, in units of the scene.
const RANGE: f64 = 1.0;

/// SE(3) whose motions are checked at steps of this length: RRT-Connect divides the length that the
/// space returns by ten.
struct Stepped(SE3StateSpace, f64);

impl StateSpace for Stepped {
    type StateType = SE3State;

    fn distance(&self, a: &SE3State, b: &SE3State) -> f64 {
        self.0.distance(a, b)
    }
    fn interpolate(&self, a: &SE3State, b: &SE3State, t: f64, at: &mut SE3State) {
        self.0.interpolate(a, b, t, at);
    }
    fn enforce_bounds(&self, state: &mut SE3State) {
        self.0.enforce_bounds(state);
    }
    fn satisfies_bounds(&self, state: &SE3State) -> bool {
        self.0.satisfies_bounds(state)
    }
    fn sample_uniform(&self, rng: &mut impl rand::Rng) -> Result<SE3State, StateSamplingError> {
        self.0.sample_uniform(rng)
    }
    fn get_longest_valid_segment_length(&self) -> f64 {
        10.0 * self.1
    }
}

/// A single goal.
struct Only(SE3State);

impl Goal<SE3State> for Only {
    fn is_satisfied(&self, state: &SE3State) -> bool {
        configuration(state) == configuration(&self.0)
    }
}

impl GoalRegion<SE3State> for Only {
    fn distance_goal(&self, state: &SE3State) -> f64 {
        f64::from(u8::from(!self.is_satisfied(state)))
    }
}

impl GoalSampleableRegion<SE3State> for Only {
    fn sample_goal(&self, _: &mut impl rand::Rng) -> Result<SE3State, StateSamplingError> {
        Ok(self.0.clone())
    }
}

/// A test of single configurations.
struct Valid<F>(RefCell<F>);

impl<F: FnMut(&[f64]) -> bool> StateValidityChecker<SE3State> for Valid<F> {
    fn is_valid(&self, state: &SE3State) -> bool {
        (self.0.borrow_mut())(&configuration(state))
    }
}

fn configuration(state: &SE3State) -> Vec<f64> {
    let turn = state.get_rotation();
    vec![
        state.get_x(),
        state.get_y(),
        state.get_z(),
        turn.x,
        turn.y,
        turn.z,
        turn.w,
    ]
}

fn state(q: &[f64]) -> SE3State {
    SE3State::new(q[0], q[1], q[2], SO3State::new(q[3], q[4], q[5], q[6]))
}

/// Searches a path of a rigid body, testing configurations at fixed steps; `None` at the time
/// limit.
pub(crate) fn search(
    space: &impl ConfigurationSpace,
    [start, goal]: [&[f64]; 2],
    step: f64,
    seed: u64,
    limit: Duration,
    is_clear: impl FnMut(&[f64]) -> bool + 'static,
) -> Option<Vec<Vec<f64>>> {
    let bounds = space.bounds().iter().map(|[low, high]| (*low, *high)).collect();
    let se3 = SE3StateSpace::new(space.scales()[3], Some(bounds)).expect("finite bounds");
    let problem = ProblemDefinition {
        space: Arc::new(Stepped(se3, step)),
        start_states: vec![state(start)],
        goal: Arc::new(Only(state(goal))),
    };
    let mut planner = RRTConnect::new(RANGE, 0.05, &PlannerConfig { seed: Some(seed) });
    planner.setup(Arc::new(problem), Arc::new(Valid(RefCell::new(is_clear))));
    let path = planner.solve(limit).ok()?;
    Some(path.0.iter().map(configuration).collect())
}
