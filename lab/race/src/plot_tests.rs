//! Charts contain the given points and no NaN.

use super::draw::{TITLE, short};
use super::*;

fn chart() -> Chart {
    let points = (1..50).map(|i| (i as f64, (i * i) as f64));
    Chart::new("squares & co")
        .axes("n", "n^2")
        .line("exact", points.clone())
        .curve("twice", points.map(|(x, y)| (x, 2.0 * y)))
}

#[test]
fn all_four_kinds_of_axes_draw() {
    for c in [
        chart(),
        chart().log_x(),
        chart().log_y(),
        chart().log_x().log_y().size(400, 300),
    ] {
        let svg = c.svg().unwrap();
        assert!(svg.starts_with("<svg") && svg.trim_end().ends_with("</svg>"));
        for word in ["squares &amp; co", "exact", "twice", "n^2", "polyline", "circle"] {
            assert!(svg.contains(word), "{word}");
        }
        assert!(!svg.contains("NaN"));
    }
}

#[test]
fn gaps_zeros_and_emptiness_do_no_harm() {
    let c = Chart::new("gaps")
        .log_y()
        .line("l", [(0.0, 1.0), (1.0, f64::NAN), (2.0, 0.0), (3.0, 1e-9), (4.0, 1e9)]);
    assert!(!c.svg().unwrap().contains("NaN"));
    assert!(Chart::new("none").svg().is_ok());
    assert!(Chart::new("none").log_x().log_y().line("l", []).svg().is_ok());
    assert!(Chart::new("one").dots("d", [(1.0, 0.0)]).from_zero().svg().is_ok());
}

#[test]
fn charts_stack_beneath_one_another() {
    let svg = stack(&[&chart().size(600, 200), &chart().log_y().size(500, 300)]).unwrap();
    assert!(svg.starts_with("<svg role=\"img\"") && svg.contains("width=\"600\" height=\"500\""));
    // Two captions, and both again in the title of the picture.
    assert_eq!(svg.matches("squares &amp; co").count(), 4);
}

#[test]
fn a_narrow_logarithmic_axis_still_has_numbers() {
    let svg = Chart::new("")
        .log_y()
        .line("l", [(0.0, 38.0), (1.0, 91.0)])
        .svg()
        .unwrap();
    let labels = svg
        .lines()
        .filter_map(|l| l.parse::<f64>().ok())
        .filter(|v| (38.0..91.0).contains(v))
        .count();
    assert!(labels >= 2, "{labels}");
}

#[test]
fn numbers_are_short() {
    assert_eq!(
        [0.1 + 0.2, 0.0, 1e-9, 1200.0, 2e7].map(short),
        ["0.3", "0", "1e-9", "1200", "2e7"]
    );
}

#[test]
fn a_file_that_cannot_be_written_is_named() {
    let below_a_file = concat!(env!("CARGO_MANIFEST_DIR"), "/Cargo.toml/a.svg");
    assert!(chart().save(below_a_file).unwrap_err().contains("a.svg"));
}

#[test]
fn words_stand_beside_their_points_and_legends_beside_the_axes() {
    let at = |x: f64, word: &str| Spread {
        x: [x, 1.1 * x, 1.2 * x],
        y: [1.0, 2.0, 3.0],
        word: word.into(),
    };
    let close = [at(1.0, "one"), at(1.01, "two"), at(1.02, ""), at(100.0, "at the end")];
    let svg = Chart::new("words")
        .log_x()
        .log_y()
        .spreads("first", close)
        .spreads("second", [at(f64::NAN, "nowhere")])
        .legend_beside()
        .svg()
        .unwrap();
    for word in ["one", "two", "at the end", "first", "second"] {
        assert!(svg.contains(word), "{word}");
    }
    assert!(!svg.contains("nowhere") && !svg.contains("NaN"));
    let place = |word: &str| {
        let line = svg
            .lines()
            .rev()
            .skip_while(|l| !l.contains(word))
            .find(|l| l.contains("<text"));
        line.and_then(|l| l.split("y=\"").nth(1)?.split('"').next()?.parse::<f64>().ok())
            .unwrap()
    };
    assert!((place("one") - place("two")).abs() >= 13.0, "words hide each other");
}

#[test]
fn a_long_title_is_set_smaller_and_a_short_one_is_not() {
    let size = |c: &Chart| c.title_size();
    let long =
        Chart::new("a title of more letters than there is room for beside the legend, ninety or so of them in all");
    assert_eq!(size(&Chart::new("short").legend_beside()), TITLE as i32);
    assert_eq!(size(&long), TITLE as i32);
    let set = size(&long.legend_beside());
    assert!((10..TITLE as i32).contains(&set), "{set}");
}
