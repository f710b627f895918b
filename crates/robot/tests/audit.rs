//! Audits of pairs over parts of the joint limits: together they say what an audit over all limits
//! says.

use std::collections::BTreeSet;
use std::ops::ControlFlow;

use lin_canny_robot::plan::{Checker, ConfigurationSpace, JointTree, PlanError, RangeOptions};
use lin_canny_robot::{AuditVerdict, RobotFiles, audit, audit_pair};

fn gripper() -> Checker<JointTree> {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/examples");
    let mut files = RobotFiles::new(format!("{folder}/gripper.urdf"));
    files.cell = Some(format!("{folder}/cell.json").into());
    files.load().expect("the example").1.checker().expect("a checker")
}

fn limits(checker: &Checker<JointTree>) -> [Vec<f64>; 2] {
    [0, 1].map(|k| checker.space().bounds().iter().map(|ends| ends[k]).collect())
}

#[test]
fn a_pair_has_the_answers_of_the_audit() {
    let mut checker = gripper();
    let options = RangeOptions::default().cells(60);
    let go = &mut |_| ControlFlow::Continue(());
    let all = audit(&mut checker, &options, &[], go).expect("an audit");
    let [low, high] = limits(&checker);
    let mut seen = BTreeSet::new();
    for one in &all {
        let [a, b] = one.names.each_ref().map(String::as_str);
        let alone = audit_pair(&mut checker, [a, b], [&low, &high], &options).expect("a pair");
        assert_eq!(alone.answers, one.answers, "{a} {b}");
        assert_eq!(
            (
                alone.verdict,
                alone.joints,
                alone.lower,
                alone.upper,
                alone.open,
                alone.cells
            ),
            (one.verdict, one.joints, one.lower, one.upper, one.open, one.cells)
        );
        seen.insert(one.verdict);
    }
    assert!(
        seen.contains(&AuditVerdict::Never) && seen.contains(&AuditVerdict::Both),
        "{seen:?}"
    );
}

#[test]
fn halves_of_the_limits_say_together_what_all_say() {
    let mut checker = gripper();
    let [low, high] = limits(&checker);
    let options = RangeOptions::default().cells(400);
    for (names, expected) in [
        (["base", "upper arm"], AuditVerdict::Never),
        (["base", "gripper"], AuditVerdict::Both),
    ] {
        // The first two joints are divided: four cells.
        let cells: Vec<AuditVerdict> = (0..4)
            .map(|cell| {
                let (mut from, mut to) = (low.clone(), high.clone());
                for k in 0..2 {
                    let middle = 0.5 * (low[k] + high[k]);
                    if cell >> k & 1 == 0 {
                        to[k] = middle
                    } else {
                        from[k] = middle
                    }
                }
                audit_pair(&mut checker, names, [&from, &to], &options)
                    .expect("a pair")
                    .verdict
            })
            .collect();
        let is_never = cells.iter().all(|verdict| *verdict == AuditVerdict::Never);
        assert_eq!(is_never, expected == AuditVerdict::Never, "{cells:?}");
        let is_mixed = |verdict| cells.contains(&verdict);
        let is_both = is_mixed(AuditVerdict::Both) || (is_mixed(AuditVerdict::Never) && is_mixed(AuditVerdict::Always));
        assert_eq!(is_both, expected == AuditVerdict::Both, "{cells:?}");
    }
}

#[test]
fn pairs_and_ranges_that_do_not_exist_are_errors() {
    let mut checker = gripper();
    let [low, high] = limits(&checker);
    let options = RangeOptions::default();
    let wrong = audit_pair(&mut checker, ["bas", "gripper"], [&low, &high], &options);
    assert!(wrong.is_err_and(|e| e.to_string() == r#"body "bas" does not exist (nearest: "base")"#));
    let empty = audit_pair(&mut checker, ["base", "gripper"], [&high, &low], &options);
    assert!(matches!(empty, Err(PlanError::Range { index: 0, .. })), "{empty:?}");
    let short = audit_pair(&mut checker, ["base", "gripper"], [&low[1..], &high], &options);
    assert!(matches!(short, Err(PlanError::Length { .. })), "{short:?}");
    let same = audit_pair(&mut checker, ["base", "base"], [&low, &high], &options);
    assert!(same.is_err(), "{same:?}");
}
