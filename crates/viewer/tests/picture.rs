//! Pictures without a display: the pixels show what is on the stage.
//!
//! The tests need a graphics driver, possibly one in software, and fail without it. `.ci/viewer`
//! then skips them and reports it.

use lin_canny_record::Recording;
use lin_canny_viewer::app::{Source, Viewer};
use lin_canny_viewer::headless::Headless;

const SIZE: [u32; 2] = [640, 480];

fn open(name: &str) -> Headless {
    let mut headless = Headless::new(SIZE, Some(4)).unwrap();
    let file = format!("{}/examples/{name}.jsonl", env!("CARGO_MANIFEST_DIR"));
    headless.viewer.open(Recording::open(file).unwrap());
    headless.viewer.panel = false;
    headless
}

fn show(viewer: &mut Viewer, frame: usize) {
    let Source::Recording(player) = &mut viewer.source else {
        panic!("a recording")
    };
    player.show(frame, &mut viewer.stage);
}

fn draw(headless: &mut Headless) -> Vec<u8> {
    headless.frame(Vec::new()).unwrap();
    headless.frame(Vec::new()).unwrap();
    headless.pixels().unwrap()
}

fn count(pixels: &[u8], is: fn(i32, i32, i32) -> bool) -> usize {
    let rgb = pixels.chunks(4).map(|p| [0, 1, 2].map(|k| i32::from(p[k])));
    rgb.filter(|&[r, g, b]| is(r, g, b)).count()
}

fn is_blue(r: i32, g: i32, b: i32) -> bool {
    b > r + 50 && b > g + 20
}

fn is_orange(r: i32, g: i32, b: i32) -> bool {
    r > g + 30 && g > b + 35
}

fn is_gap(r: i32, g: i32, b: i32) -> bool {
    r > 220 && g < 120 && b > 140
}

fn is_lit(r: i32, g: i32, b: i32) -> bool {
    g > r + 50 && g > b + 50
}

fn is_background(r: i32, g: i32, b: i32) -> bool {
    (r - 237).abs() <= 2 && (g - 240).abs() <= 2 && (b - 245).abs() <= 2
}

#[test]
fn bodies_features_and_segment_are_seen() {
    let mut headless = open("pair");
    show(&mut headless.viewer, 20);
    let pixels = draw(&mut headless);
    assert!(count(&pixels, is_blue) > 3000, "{} blue", count(&pixels, is_blue));
    assert!(count(&pixels, is_orange) > 1500, "{} orange", count(&pixels, is_orange));
    // Both ends cover about 70 pixels, and the segment between them as many.
    assert!(
        count(&pixels, is_gap) > 100,
        "{} of the segment",
        count(&pixels, is_gap)
    );
    // Two vertices, then two edges.
    for frame in [10, 30] {
        show(&mut headless.viewer, frame);
        let pixels = draw(&mut headless);
        assert!(
            count(&pixels, is_lit) > 100,
            "{} lit at {frame}",
            count(&pixels, is_lit)
        );
    }
    show(&mut headless.viewer, 20);
    headless.viewer.show.witnesses = false;
    let without = draw(&mut headless);
    assert!(count(&without, is_gap) + count(&without, is_lit) < 20);
    // Another frame gives another picture; the same frame gives the same picture.
    show(&mut headless.viewer, 70);
    assert_ne!(draw(&mut headless), without);
    show(&mut headless.viewer, 20);
    assert_eq!(draw(&mut headless), without);
}

#[test]
fn a_body_of_every_kind_is_drawn() {
    let mut headless = open("kinds");
    headless.viewer.show.witnesses = false;
    for body in 0..headless.viewer.stage.bodies.len() {
        for (k, other) in headless.viewer.stage.bodies.iter_mut().enumerate() {
            other.shown = k == body;
        }
        let pixels = draw(&mut headless);
        let drawn = pixels.len() / 4 - count(&pixels, is_background);
        let name = &headless.viewer.stage.bodies[body].name;
        assert!(drawn > 400, "{name}: {drawn} pixels");
    }
}

#[test]
fn a_drag_changes_the_answer() {
    let mut headless = open("pair");
    show(&mut headless.viewer, 20);
    draw(&mut headless);
    let before = headless.viewer.outcome().unwrap();
    // The position of the second body on the screen, by its colour.
    let pixels = headless.pixels().unwrap();
    let places: Vec<[f32; 2]> = (0..pixels.len() / 4)
        .filter(|i| {
            let [r, g, b] = [0, 1, 2].map(|k| i32::from(pixels[4 * i + k]));
            is_orange(r, g, b)
        })
        .map(|i| [(i % SIZE[0] as usize) as f32, (i / SIZE[0] as usize) as f32])
        .collect();
    let mean = [0, 1].map(|k| places.iter().map(|p| p[k]).sum::<f32>() / places.len() as f32);
    headless.drag(mean, [40.0, 30.0]).unwrap();
    let after = headless.viewer.outcome().unwrap();
    assert!((after.distance - before.distance).abs() > 0.02, "{before} {after}");
    assert!(after.lower <= after.distance && after.distance <= after.upper);
    assert_eq!(headless.viewer.stage.bodies[0].pose, Default::default());
}

#[test]
fn decorations_are_seen() {
    let mut headless = open("pile");
    show(&mut headless.viewer, 30);
    headless.viewer.show.boxes = false;
    let plain = draw(&mut headless);
    let yellow = |r: i32, g: i32, b: i32| r > 200 && g > 170 && b < 110;
    assert!(count(&plain, yellow) > 100, "contacts");
    for switch in ["boxes", "columns", "regions"] {
        let show = &mut headless.viewer.show;
        let before = *show;
        match switch {
            "boxes" => show.boxes = true,
            "columns" => show.columns = true,
            _ => show.regions = true,
        }
        let with = draw(&mut headless);
        let changed = plain.iter().zip(&with).filter(|(p, q)| p != q).count();
        assert!(changed > 500, "{switch}: {changed}");
        headless.viewer.show = before;
    }
    let mut headless = open("cast");
    let with = draw(&mut headless);
    headless.viewer.show.brackets = false;
    assert_ne!(with, draw(&mut headless));
}

#[test]
fn every_demonstration_opens() {
    let mut headless = Headless::new(SIZE, Some(1)).unwrap();
    for number in 0..lin_canny_viewer::demo::NAMES.len() {
        headless.viewer.open_demo(number).unwrap();
        let pixels = draw(&mut headless);
        assert!(count(&pixels, is_background) < pixels.len() / 4 * 9 / 10, "{number}");
    }
    assert!(headless.viewer.open_demo(99).is_err());
}
