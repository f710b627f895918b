//! A checker that has forgotten answers as a new one, bit for bit.

use lin_canny_plan::{Checker, ConfigurationSpace, JointMotion, JointTree};
use truth::arm::{self, motion};
use truth::cells::ArmCell;
use truth::rng::Rng;

fn of_meshes() -> Checker<JointTree> {
    let cell = ArmCell::new(5);
    Checker::new(cell.arm(), cell.cell()).expect("a cell")
}

fn of_hulls() -> Checker<JointTree> {
    let (arm, cell) = arm::in_cell().expect("the built-in cell");
    Checker::new(arm, cell).expect("a cell")
}

/// How many questions [`ask`] knows.
const QUESTIONS: usize = 5;

/// What a checker says about two configurations; `Debug` writes every digit, and the sign of zero.
fn ask(checker: &mut Checker<JointTree>, question: usize, q: &[f64], p: &[f64]) -> String {
    match question {
        0 => format!("{:?}", checker.clearance(q)),
        1 => format!("{:?}", checker.nearest(q, 0.1)),
        2 => format!("{:?}", checker.is_free_at(q)),
        3 => format!("{:?}", checker.certify(&JointMotion::segment(q, p))),
        _ => format!("{:?}", crate::prove(checker, &JointMotion::segment(q, p))),
    }
}

/// Returns how many answers of a checker that has not forgotten differ from those of a new one.
fn judge(new: impl Fn() -> Checker<JointTree>, draw: impl Fn(&mut Rng) -> Vec<f64>, count: usize) -> usize {
    let (mut rng, mut warm, mut forgetful) = (Rng::new(17), new(), new());
    let (mut q, mut differing) = (draw(&mut rng), 0);
    for k in 0..count {
        // Far, near, and the same again.
        q = match k % 3 {
            0 => draw(&mut rng),
            1 => {
                let steps: Vec<f64> = q.iter().map(|_| rng.range(-0.01, 0.01)).collect();
                warm.space().moved(&q, &steps)
            }
            _ => q,
        };
        let steps: Vec<f64> = q.iter().map(|_| rng.range(-0.1, 0.1)).collect();
        let p = warm.space().moved(&q, &steps);
        for question in 0..QUESTIONS {
            let expected = ask(&mut new(), question, &q, &p);
            forgetful.reset();
            assert_eq!(ask(&mut forgetful, question, &q, &p), expected, "{q:?} {p:?}");
            differing += usize::from(ask(&mut warm, question, &q, &p) != expected);
        }
    }
    differing
}

#[test]
fn hulls_are_forgotten() {
    let draw = |rng: &mut Rng| motion::carry(rng.range(0.0, 1.0));
    let differing = judge(of_hulls, draw, 60);
    assert!(differing > 0, "nothing to reset");
}

#[test]
fn meshes_are_forgotten() {
    let differing = judge(of_meshes, ArmCell::sample, 24);
    assert!(differing > 0, "nothing to reset");
}
