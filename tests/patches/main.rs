//! Promise: intervals of curved surfaces hold the truth and are as narrow as asked.
mod bodies;
use bodies::*;
use lab::rng::Rng;
use lin_canny::nalgebra::*;
use lin_canny::patch::*;
use std::time::Instant;

#[test]
fn try_speed() {
    let mut rng = Rng::new(7);
    for (bump, width) in [(0.5, 1e-4), (0.5, 1e-9), (1.5, 1e-9)] {
        let mut times = vec![];
        let mut work = vec![];
        let mut bad = 0;
        for _ in 0..200 {
            let a = Surface::new(vec![bumpy(&mut rng, [3, 3], bump)]).unwrap();
            let b = Surface::new(vec![bumpy(&mut rng, [3, 3], bump)]).unwrap();
            let p = pose(&place(&mut rng, 3.0));
            let mut t = SurfaceTracker::new();
            let now = Instant::now();
            let o = t.closest(&a, &b, &p, width);
            times.push(now.elapsed().as_secs_f64() * 1e6);
            if !o.is_reached {
                bad += 1;
            }
            work.push(t.work());
        }
        times.sort_by(f64::total_cmp);
        let mean = |f: &dyn Fn(&SurfaceWork) -> u64| work.iter().map(f).sum::<u64>() as f64 / 200.0;
        println!(
            "bump {bump} width {width}: cold us {:.1} p90 {:.1} max {:.1}; splits {} gaps {} caps {} steps {} bad {bad}",
            times[100],
            times[180],
            times[199],
            mean(&|w| w.splits),
            mean(&|w| w.gaps),
            mean(&|w| w.caps),
            mean(&|w| w.steps)
        );
    }
    let v = vase();
    for width in [1e-4, 1e-9] {
        let mut t = SurfaceTracker::new();
        let mut times = vec![];
        let mut last = t.work();
        for k in 0..720 {
            let an = (k as f64 * 0.5).to_radians();
            let iso = Isometry3::from_parts(
                Translation3::new(2.2 * an.cos(), 2.2 * an.sin(), 0.3),
                UnitQuaternion::from_euler_angles(an, 0.7 * an, 0.2),
            );
            let p = pose(&iso);
            let now = Instant::now();
            let o = t.closest(&v, &v, &p, width);
            let us = now.elapsed().as_secs_f64() * 1e6;
            if k == 0 {
                println!("vase cold {us:.1} {:?}", t.work());
                last = t.work();
            }
            times.push(us);
            assert!(o.is_reached, "{o:?}");
        }
        times.sort_by(f64::total_cmp);
        println!(
            "vase {width}: warm median {:.1} p90 {:.1} max {:.1} front {} {:?} cold {:?}",
            times[360],
            times[648],
            times[719],
            t.front_len(),
            t.work(),
            last
        );
    }
}

#[test]
fn spheres() {
    let (a, b) = (sphere(1.0), sphere(0.5));
    assert!(a.is_closed());
    let mut rng = Rng::new(3);
    for k in 0..200 {
        let gap = 10f64.powf(rng.range(-9.0, 0.5));
        let p = pose(&place(&mut rng, 1.5 + gap));
        let mut t = SurfaceTracker::new();
        let o = t.closest(&a, &b, &p, 1e-9);
        assert!(o.is_reached, "{k} {gap} {o:?} {:?}", t.work());
        let gap = p.poses().1.translation.vector.norm() - 1.5;
        assert!(o.lower <= gap + 1e-14 && gap <= o.upper + 1e-14, "{gap} {o:?}");
    }
}
