//! Robots and cells from texts: URDF, MJCF, SDFormat, JSON; trajectories.

use crate::{Random, Teller};
use lin_canny::nalgebra::Isometry3;
use lin_canny_plan::{Cell, Checker, ConfigurationSpace};
use lin_canny_robot::{CellFile, LoadOptions, Packages, Robot, Trajectory};
use std::fmt::Write;

/// Returns a decimal of three digits up to `most` thousandths, so that the text is short.
fn decimal(r: &mut Random, most: u64) -> f64 {
    (r.below(2 * most) as f64 - most as f64) / 1000.0
}

/// Returns decimals, separated by spaces.
fn decimals(r: &mut Random, most: &[u64]) -> String {
    let all: Vec<_> = most.iter().map(|&most| decimal(r, most).to_string()).collect();
    all.join(" ")
}

fn tell_robot(t: &mut Teller, r: &mut Random, text: &str, name: &str, cell: Option<&CellFile>) -> Robot {
    let options = LoadOptions::default();
    let robot = Robot::parse(text, name, &Packages::default(), &options).expect("a robot");
    for (joint, link) in robot.joints().iter().zip(robot.links()) {
        t.tell("joint", (joint.origin, joint.axis));
        t.tell("link", link.bodies.iter().map(|b| b.origin).collect::<Vec<_>>());
    }
    let mut setup = Cell::new();
    setup.add_robot("", &robot, Isometry3::identity()).expect("a robot");
    setup.exclude_adjacent();
    if let Some(cell) = cell {
        cell.add_to(&mut setup).expect("a cell");
    }
    let mut checker = Checker::of_robots(setup.clone()).expect("a checker");
    for _ in 0..5 {
        let q = checker.space().sample(&mut || r.range(0.0, 1.0));
        t.tell("clearance", checker.clearance(&q));
    }
    robot
}

/// Returns a URDF of six links.
fn urdf_text(r: &mut Random) -> String {
    let mut text = String::from("<robot name=\"r\"><link name=\"l0\"/>");
    for k in 1..=6 {
        let turn = [3141, 1571, 3141];
        let (origin, about) = (decimals(r, &[300; 3]), decimals(r, &turn));
        let (turned, axis) = (decimals(r, &turn), decimals(r, &[1000; 2]));
        let parent = k - 1;
        write!(
            text,
            "<link name=\"l{k}\"><collision><origin xyz=\"0 0 0.1\" rpy=\"{turned}\"/>\
             <geometry><box size=\"0.1 0.12 0.2\"/></geometry></collision></link>\
             <joint name=\"j{k}\" type=\"revolute\"><parent link=\"l{parent}\"/><child link=\"l{k}\"/>\
             <origin xyz=\"{origin}\" rpy=\"{about}\"/><axis xyz=\"{axis} 2.5\"/>\
             <limit lower=\"-2\" upper=\"2\" effort=\"1\" velocity=\"1\"/></joint>"
        )
        .expect("text");
    }
    text + "</robot>"
}

pub(super) fn urdf(t: &mut Teller, r: &mut Random) {
    for _ in 0..t.rounds(60) {
        let text = urdf_text(r);
        let (turn, about) = (decimals(r, &[3141; 3]), decimals(r, &[1000; 3]));
        let cell = format!(
            "{{\"bodies\": [{{\"name\": \"table\", \"box\": {{\"size\": [1.3, 1.5, 0.04]}}, \"xyz\": [{}], \"rpy\": [{}]}}, \
             {{\"name\": \"can\", \"cylinder\": {{\"radius\": 0.1, \"length\": 0.3}}, \"xyzw\": [{}, 1.5]}}]}}",
            decimals(r, &[900; 3]).replace(' ', ", "),
            turn.replace(' ', ", "),
            about.replace(' ', ", ")
        );
        let cell = CellFile::parse(&cell, "cell.json", &Packages::default(), &LoadOptions::default()).expect("a cell");
        t.tell("cell", cell.obstacles.iter().map(|o| o.pose).collect::<Vec<_>>());
        let robot = tell_robot(t, r, &text, "r.urdf", Some(&cell));
        let mut rows = String::from("time,j1,j2,j3,j4,j5,j6\n");
        for k in 0..4 {
            writeln!(rows, "{k},{}", decimals(r, &[1900; 6]).replace(' ', ",")).expect("text");
        }
        let rows = Trajectory::parse_timed(&rows, "q.csv", robot.coordinates(), &[]).expect("a trajectory");
        t.tell("rows", &rows.rows);
        t.tell("curves", rows.curves());
    }
}

pub(super) fn mjcf(t: &mut Teller, r: &mut Random) {
    for _ in 0..t.rounds(60) {
        let mut text = String::from("<mujoco><compiler angle=\"radian\" eulerseq=\"zYx\"/><worldbody>");
        for k in 1..=5 {
            let place = decimals(r, &[300; 3]);
            let way = match k % 4 {
                0 => format!("euler=\"{}\"", decimals(r, &[3141; 3])),
                1 => format!("axisangle=\"{} 1.5 {}\"", decimals(r, &[1000; 2]), decimals(r, &[3141])),
                2 => format!("xyaxes=\"2 {} {} 3 0.5\"", decimals(r, &[500; 2]), decimals(r, &[500])),
                _ => format!("zaxis=\"{} 2.5\"", decimals(r, &[1000; 2])),
            };
            let fromto = format!("0 0 0 {} 0.3", decimals(r, &[300; 2]));
            write!(
                text,
                "<body name=\"b{k}\" pos=\"{place}\" {way}><joint name=\"j{k}\" type=\"hinge\" range=\"-2 2\" \
                 axis=\"{} 2.5\"/><geom type=\"capsule\" fromto=\"{fromto}\" size=\"0.03\"/>\
                 <geom type=\"box\" size=\"0.05 0.06 0.1\" euler=\"{}\"/>",
                decimals(r, &[1000; 2]),
                decimals(r, &[3141; 3])
            )
            .expect("text");
        }
        text += &"</body>".repeat(5);
        text += "</worldbody></mujoco>";
        tell_robot(t, r, &text, "r.xml", None);
    }
}

pub(super) fn sdformat(t: &mut Teller, r: &mut Random) {
    for _ in 0..t.rounds(60) {
        let mut text = String::from("<sdf version=\"1.9\"><model name=\"m\"><link name=\"l0\"/>");
        for k in 1..=5 {
            let parent = k - 1;
            write!(
                text,
                "<link name=\"l{k}\"><pose relative_to=\"l{parent}\">{} {}</pose><collision name=\"c\">\
                 <pose degrees=\"1\">0 0 0.1 {}</pose><geometry><box><size>0.1 0.12 0.2</size></box></geometry></collision></link>\
                 <joint name=\"j{k}\" type=\"revolute\"><parent>l{parent}</parent><child>l{k}</child>\
                 <axis><xyz>{} 2.5</xyz><limit><lower>-2</lower><upper>2</upper></limit></axis></joint>",
                decimals(r, &[300; 3]),
                decimals(r, &[3141, 1571, 3141]),
                decimals(r, &[180_000; 3]),
                decimals(r, &[1000; 2])
            )
            .expect("text");
        }
        tell_robot(t, r, &(text + "</model></sdf>"), "r.sdf", None);
    }
}
