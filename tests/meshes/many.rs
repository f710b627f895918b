//! Families of poses against brute force: a few hundred each by default, ten thousand with
//! `--ignored`.

use super::{judge_by_surfaces, mesh, relative};
use lin_canny::{ContactState, PairTracker};
use truth::Pose;
use truth::pose::{add, quat, quat_mul, scale, unit_quat};
use truth::rng::Rng;
use truth::soups::{self, Soup};
use truth::turned;

/// Relation of successive poses.
#[derive(Clone, Copy, Debug)]
enum Motion {
    /// Random nearby poses.
    Random,
    /// Half a degree per frame, in and out of contact.
    Tracked,
    /// Moved along the normal to gaps of 1 to 1e-12.
    Gaps,
    /// Sliding and rotating on a face, at gaps of 0 to 1e-6.
    Flush,
    /// Shifted by multiples of a quarter: faces in shared planes, edges on edges.
    Grid,
    /// A shaft that rotates about its axis across another, at gaps of -0.05 to 0.3.
    Crossing,
    /// Rotating about the axis of the other with a drift, in a bore that is a tenth wider.
    Held,
}

/// Returns how many poses were separated, touching, overlapping, and with one body inside the
/// other.
fn family(a: &Soup, b: &Soup, motion: Motion, count: usize, seed: u64) -> [usize; 4] {
    let (m, n) = (mesh(a), mesh(b));
    let mut rng = Rng::new(seed);
    let reach = a.radius() + b.radius();
    let (mut q, axis, at) = (rng.quat(), rng.unit(), rng.unit());
    let mut tracker = PairTracker::new();
    let mut tally = [0; 4];
    for k in 0..count {
        let mut pose = match motion {
            Motion::Random | Motion::Gaps => Pose::new(rng.quat(), scale(rng.unit(), reach * rng.range(0.1, 1.1))),
            Motion::Tracked => {
                q = unit_quat(quat_mul(quat(axis, 0.5f64.to_radians()), q));
                let swing = 0.55 + 0.3 * (0.02 * k as f64).sin();
                Pose::new(q, scale(at, reach * swing))
            }
            Motion::Flush => {
                let angle = 0.009 * k as f64;
                let gap = [0.0, 1e-12, 1e-9, 1e-6][k / 16 % 4];
                Pose::new(
                    quat([0.0, 0.0, 1.0], angle),
                    [0.3 * angle.sin(), 0.2 * angle.cos(), 0.1 + gap],
                )
            }
            Motion::Crossing => {
                let angle = [1.0f64, 10.0, 45.0, 90.0][k / 32 % 4].to_radians();
                let gap = [0.3, 0.05, 1e-3, -0.05][k / 8 % 4];
                let turn = quat([0.0, 0.0, 1.0], 0.009 * k as f64);
                Pose::new(
                    unit_quat(quat_mul(quat([1.0, 0.0, 0.0], angle), turn)),
                    [2.0 + gap, 0.3 * (0.1 * k as f64).sin(), 0.0],
                )
            }
            Motion::Held => {
                let (s, c) = (0.02 * k as f64).sin_cos();
                let off = 0.12 * (0.05 * k as f64).sin();
                Pose::new(
                    quat(
                        [0.02 * s, 0.0, 1.0].map(|x| x / (1.0 + 4e-4 * s * s).sqrt()),
                        0.009 * k as f64,
                    ),
                    [off * c, off * s, 0.3 * s],
                )
            }
            Motion::Grid => Pose::shift([0, 1, 2].map(|_| 0.25 * rng.range(-5.0, 5.0).round())),
        };
        if matches!(motion, Motion::Gaps) {
            let target = 10f64.powi(-((k % 13) as i32));
            for _ in 0..3 {
                let found = PairTracker::new().closest(&m, &n, &relative(&pose));
                let n = found.normal.into_inner();
                pose.t = add(pose.t, scale([n.x, n.y, n.z], target - found.distance));
            }
        }
        tally[match judge_by_surfaces(&mut tracker, (a, b), (&m, &n), &pose) {
            (ContactState::Separated, _) => 0,
            (ContactState::Touching, _) => 1,
            (_, 0.0) => 2,
            _ => 3,
        }] += 1;
    }
    tally
}

fn run(count: usize) {
    let mut rng = Rng::new(77);
    let plate = soups::plate(3, [1.0, 1.0, 0.05]);
    let cube = soups::plate(2, [0.5, 0.5, 0.5]);
    let (torus, knot) = (soups::torus(14, 7, 0.3), soups::knot(24, 5, 0.12));
    let (rock, gear, bracket) = (soups::rock(1, 3), soups::gear(6), soups::bracket());
    let (loose, slivers) = (soups::loose(60, 0.2, &mut rng), soups::slivers(60, &mut rng));
    let nested = soups::sphere(1).with(&soups::sphere(1).map(|p| scale(p, 0.5)).flipped());
    let pebble = soups::sphere(0).map(|p| scale(p, 0.1));
    let (shaft, cone) = (turned::shaft(17), turned::cone(12));
    let (bearing, link, tray) = (turned::bearing(14, 1.1), turned::link(7), turned::tray(3));
    let families = [
        ("random", &torus, &knot, Motion::Random),
        ("tracked", &torus, &torus, Motion::Tracked),
        ("tracked", &rock, &gear, Motion::Tracked),
        ("gaps", &gear, &bracket, Motion::Gaps),
        ("gaps", &rock, &torus, Motion::Gaps),
        ("flush", &plate, &plate, Motion::Flush),
        ("grid", &cube, &cube, Motion::Grid),
        ("grid", &bracket, &cube, Motion::Grid),
        ("loose", &loose, &slivers, Motion::Random),
        ("unwelded", &rock.unwelded(), &gear.unwelded(), Motion::Random),
        ("nested", &nested, &pebble, Motion::Random),
        ("crossing", &shaft, &shaft, Motion::Crossing),
        ("crossing", &cone, &shaft, Motion::Crossing),
        ("tumbling", &shaft, &cone, Motion::Tracked),
        ("held", &shaft, &bearing, Motion::Held),
        ("gaps", &bearing, &cone, Motion::Gaps),
        ("gaps", &tray, &link, Motion::Gaps),
    ];
    let mut sum = [0; 4];
    for (k, (name, a, b, motion)) in families.into_iter().enumerate() {
        let tally = family(a, b, motion, count, k as u64);
        println!(
            "{name:<10}{:>6}{:>6} triangles: {tally:?}",
            a.triangles.len(),
            b.triangles.len()
        );
        (0..4).for_each(|i| sum[i] += tally[i]);
    }
    assert!(sum.iter().all(|n| 10 * n > count), "{sum:?}");
}

#[test]
fn families_equal_brute_force() {
    run(150);
}

#[test]
#[ignore = "ten thousand poses a family, a quarter of an hour"]
fn ten_thousand_poses_a_family_equal_brute_force() {
    run(10_000);
}
