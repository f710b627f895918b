//! Audits of pairs over parts of the joint limits: together they say what an audit over all limits
//! says.

use std::collections::BTreeSet;
use std::ops::ControlFlow;

use lin_canny_robot::lin_canny::nalgebra::Isometry3;
use lin_canny_robot::plan::{Cell, Checker, ClearanceWidth, ConfigurationSpace, JointTree, PlanError, RangeOptions};
use lin_canny_robot::{
    AuditCell, AuditVerdict, LoadOptions, Packages, Robot, RobotFiles, audit, audit_cells, audit_pair,
};

fn gripper() -> Checker<JointTree> {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/examples");
    let mut files = RobotFiles::new(format!("{folder}/gripper.urdf"));
    files.cell = Some(format!("{folder}/cell.json").into());
    Checker::of_robots(files.load().expect("the example").cell).expect("a checker")
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
    assert!(seen.contains(&AuditVerdict::Never), "{seen:?}");
    assert!(seen.contains(&AuditVerdict::Both), "{seen:?}");
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

/// Volume of a range, in shares of the limits.
fn volume([low, high]: &[Vec<f64>; 2], limits: &[Vec<f64>; 2]) -> f64 {
    let share = |k: usize| (high[k] - low[k]) / (limits[1][k] - limits[0][k]);
    (0..low.len()).map(share).product()
}

/// What the verdicts of cells that cover a range say about the range.
fn together(cells: &BTreeSet<AuditVerdict>) -> AuditVerdict {
    let has = |verdict| cells.contains(&verdict);
    let (never, always) = (has(AuditVerdict::Never), has(AuditVerdict::Always));
    if has(AuditVerdict::Both) || (never && always) {
        AuditVerdict::Both
    } else if has(AuditVerdict::Open) {
        AuditVerdict::Open
    } else if never {
        AuditVerdict::Never
    } else {
        AuditVerdict::Always
    }
}

#[test]
fn cells_cover_the_limits_and_say_together_what_the_audit_says() {
    let mut checker = gripper();
    let limits = limits(&checker);
    // The budget is that of a cell or of the whole: cells may decide what the audit leaves open.
    let options = RangeOptions::default().cells(400);
    let all = audit(&mut checker, &options, &[], &mut |_| ControlFlow::Continue(())).expect("an audit");
    let cells = audit_cells(&mut checker, 6).expect("cells");
    assert_eq!(cells, audit_cells(&mut checker, 6).expect("cells"));
    let (mut divided, mut decided) = (0, 0);
    for one in &all {
        let of_pair: Vec<_> = cells.iter().filter(|cell| cell.names == one.names).collect();
        assert!((1..=6).contains(&of_pair.len()), "{:?}", one.names);
        let sum: f64 = of_pair.iter().map(|cell| volume(&cell.range, &limits)).sum();
        assert!((sum - 1.0).abs() < 1e-12, "{sum} {:?}", one.names);
        divided += usize::from(of_pair.len() > 1);
        let verdict = |cell: &&AuditCell| {
            let [low, high] = &cell.range;
            let [a, b] = one.names.each_ref().map(String::as_str);
            let found = audit_pair(&mut checker, [a, b], [low, high], &options).expect("a pair");
            found.verdict
        };
        let found: BTreeSet<AuditVerdict> = of_pair.iter().map(verdict).collect();
        if one.verdict != AuditVerdict::Open {
            assert_eq!(together(&found), one.verdict, "{:?} {found:?}", one.names);
            decided += 1;
        }
    }
    assert!(divided > 2 && decided > 50, "{divided} {decided}");
    let names: BTreeSet<_> = cells.iter().map(|cell| &cell.names).collect();
    assert_eq!(names.len(), all.len());
}

#[test]
fn an_audit_that_is_stopped_leaves_the_hard_pairs() {
    let mut checker = gripper();
    let options = RangeOptions::default().cells(3_000);
    let all = audit(&mut checker, &options, &[], &mut |_| ControlFlow::Continue(())).expect("an audit");
    let most = all.iter().map(|one| one.cells).max().expect("a pair");
    // Every pair has its first cells before the hardest has all.
    let mut cells = 0;
    let mut stop = |_| {
        cells += 1;
        if cells > most {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    };
    let stopped = audit(&mut checker, &options, &[], &mut stop).expect("an audit");
    assert_eq!(stopped.len(), all.len());
    let earlier: Vec<_> = stopped.iter().flat_map(|one| one.answers.clone()).collect();
    let resumed = audit(&mut checker, &options, &earlier, &mut |_| ControlFlow::Continue(())).expect("an audit");
    for (one, other) in resumed.iter().zip(&all) {
        assert_eq!((&one.names, one.verdict), (&other.names, other.verdict));
    }
}

/// A robot and its fixture, whose names start with `fixture/`.
fn with_fixture(robot: &str, fixture: &str) -> Checker<JointTree> {
    let mut setup = Cell::new();
    for (prefix, text) in [("", robot), ("fixture/", fixture)] {
        let robot = Robot::parse(text, "robot.urdf", &Packages::default(), &LoadOptions::default());
        let robot = robot.expect("a robot");
        setup.add_robot(prefix, &robot, Isometry3::identity()).expect("a robot");
    }
    Checker::of_robots(setup).expect("a checker")
}

/// A fixture is a second robot whose joints are its tolerances, and an error of a joint is a joint of
/// the robot: clearances over all motions and all tolerances, against the closed form.
#[test]
fn tolerances_are_joints_of_the_robot_and_of_the_fixture() {
    let rod = r#"<robot name="rod">
        <link name="base"/><link name="motor"/>
        <link name="rod"><collision><origin xyz="0.5 0 0"/><geometry><box size="1 0.1 0.1"/></geometry></collision></link>
        <joint name="turn" type="revolute"><parent link="base"/><child link="motor"/><axis xyz="0 0 1"/>
            <limit lower="0.5" upper="1.0" effort="1" velocity="1"/></joint>
        <joint name="error" type="revolute"><parent link="motor"/><child link="rod"/><axis xyz="0 0 1"/>
            <limit lower="-0.05" upper="0.05" effort="1" velocity="1"/></joint>
    </robot>"#;
    let fixture = r#"<robot name="fixture">
        <link name="cell"/>
        <link name="wall"><collision><geometry><box size="0.2 4 4"/></geometry></collision></link>
        <joint name="place" type="prismatic"><parent link="cell"/><child link="wall"/><origin xyz="1.3 0 0"/><axis xyz="1 0 0"/>
            <limit lower="-0.03" upper="0.03" effort="1" velocity="1"/></joint>
    </robot>"#;
    let mut checker = with_fixture(rod, fixture);
    let options = RangeOptions::default().width(ClearanceWidth::Length(1e-6));
    let all = audit(&mut checker, &options, &[], &mut |_| ControlFlow::Continue(())).expect("an audit");
    let [one] = &all[..] else { panic!("{all:?}") };
    assert_eq!(one.names, ["rod", "fixture/wall"]);
    let truth = 1.2 - 0.03 - (0.45f64.cos() + 0.05 * 0.45f64.sin());
    assert_eq!((one.verdict, one.joints), (AuditVerdict::Never, 3));
    assert!(one.lower <= truth && truth <= one.lower + 1.1e-6, "{truth} {one:?}");
}

/// A fixture whose whole pose is uncertain: a planar or a floating joint, over a part of its limits.
#[test]
fn a_fixture_on_a_planar_or_floating_joint_has_a_pose_with_a_range() {
    let rod = r#"<robot name="rod">
        <link name="base"/>
        <link name="rod"><collision><origin xyz="0.5 0 0"/><geometry><box size="1 0.1 0.1"/></geometry></collision></link>
        <joint name="turn" type="revolute"><parent link="base"/><child link="rod"/><axis xyz="0 0 1"/>
            <limit lower="0.5" upper="1.0" effort="1" velocity="1"/></joint>
    </robot>"#;
    let fixture = |kind: &str| {
        format!(
            r#"<robot name="fixture"><link name="cell"/>
            <link name="wall"><collision><geometry><box size="0.2 4 4"/></geometry></collision></link>
            <joint name="pose" type="{kind}"><parent link="cell"/><child link="wall"/><origin xyz="1.3 0 0"/><axis xyz="0 0 1"/></joint>
            </robot>"#
        )
    };
    let (place, tilt) = (0.03, 0.02);
    for (kind, half) in [
        ("planar", vec![place, place, tilt]),
        ("floating", vec![place, place, place, tilt, tilt, tilt]),
    ] {
        let mut checker = with_fixture(rod, &fixture(kind));
        let low: Vec<f64> = [0.5].into_iter().chain(half.iter().map(|h| -h)).collect();
        let high: Vec<f64> = [1.0].into_iter().chain(half.iter().copied()).collect();
        let options = RangeOptions::default().width(ClearanceWidth::Length(0.01));
        let one = audit_pair(&mut checker, ["rod", "fixture/wall"], [&low, &high], &options).expect("a pair");
        assert_eq!(one.verdict, AuditVerdict::Never, "{one:?}");
        assert_eq!(one.joints, half.len() + 1, "{one:?}");
        // The rod at rest at its nearest is 0.298 from a wall without tolerances.
        assert!(one.lower > 0.2, "{one:?}");
        assert!(one.upper < 0.3, "{one:?}");
        assert!(one.upper <= one.lower + 0.01, "{one:?}");
        let mut rng = truth::rng::Rng::new(7);
        for _ in 0..2_000 {
            let ends = low.iter().zip(&high);
            let q: Vec<f64> = ends
                .map(|(low, high)| match rng.range(0.0, 3.0) as u32 {
                    0 => *low,
                    1 => *high,
                    _ => rng.range(*low, *high),
                })
                .collect();
            let near = checker.clearance(&q).expect("a configuration").expect("a pair");
            assert!(near.upper >= one.lower, "{near:?} {one:?}");
        }
    }
}
