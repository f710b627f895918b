//! Promises of ellipsoids, radii of parts and half-spaces: a claim that is false by a billionth is refused, and one that is true with little to
//! spare is accepted, by both checkers.

mod support;

use support::python::{code, codes};
use support::*;

/// An ellipsoid, flat or not, at a pose, spinning about the origin of its frame, above the half-space z <= 0.
struct Coin {
    centre: V,
    axes: Vec<V>,
    spin: V,
    height: f64,
}

impl Coin {
    fn new(rng: &mut Rng) -> Self {
        Self {
            centre: rng.vector(1.0),
            axes: (0..1 + rng.below(3)).map(|_| rng.vector(1.0)).collect(),
            spin: rng.vector(1.0),
            height: rng.range(4.0, 6.0),
        }
    }

    /// The least height of the ellipsoid above the plane at a time.
    fn gap(&self, time: f64) -> f64 {
        let height = |v: V| turned(scale(self.spin, time), v)[2];
        let squares = self.axes.iter().map(|v| height(*v) * height(*v));
        self.height + height(self.centre) - squares.sum::<f64>().sqrt()
    }

    /// The claim that the disc keeps a distance over an interval.
    fn receipt(&self, [from, until]: [f64; 2], keep: f64) -> String {
        let (zero, identity) = (hexes(&[0.0; 3]), hexes(&REST));
        let mut at = REST;
        at[2] = self.height;
        sealed(&[
            format!(
                "{{\"receipt\":1,\"claim\":\"apart\",\"from\":{},\"until\":{},\"margin\":{}}}",
                hex(from),
                hex(until),
                hex(keep)
            ),
            format!(
                "{{\"body\":0,\"name\":\"floor\",\"half\":[{},\"0x0p0\"],\"at\":{identity}}}",
                hexes(&[0.0, 0.0, 2.0])
            ),
            format!(
                "{{\"body\":1,\"name\":\"coin\",\"points\":[{}],\"ellipsoids\":[[0,[{}]]],\"at\":{},\"steady\":{{\"pivot\":{zero},\
                 \"linear\":{zero},\"angular\":{},\"push\":{zero}}}}}",
                hexes(&self.centre),
                self.axes.iter().map(|v| hexes(v)).collect::<Vec<_>>().join(","),
                hexes(&at),
                hexes(&self.spin)
            ),
            "{\"plane\":[0,1]}".into(),
        ])
    }
}

#[test]
fn ellipsoids_above_half_spaces_are_proven_as_they_are() {
    let (mut rng, mut cases, mut wanted) = (Rng(5), Vec::new(), Vec::new());
    for _ in 0..200 {
        let coin = Coin::new(&mut rng);
        let span = [1.0, 0.1, 0.01][rng.below(3)];
        let from = rng.range(0.0, 1.0 - span);
        let times = (0..=1000).map(|k| from + span * f64::from(k) / 1000.0);
        let least = times.map(|t| coin.gap(t)).fold(f64::INFINITY, f64::min);
        // Above the least gap by rounding of this test, and below it by what the bound of a root may miss.
        for (keep, holds) in [(least + 1e-9, false), (least - 2.0 * span * span - 1e-6, span < 1.0)] {
            if keep > 0.0 && (holds || keep > least) {
                cases.push((coin.receipt([from, from + span], keep), None));
                wanted.push(i32::from(!holds));
            }
        }
    }
    for ((text, _), wanted) in cases.iter().zip(&wanted) {
        assert_eq!(code(text, None), *wanted, "{text}");
    }
    assert!(wanted.iter().filter(|code| **code == 0).count() > 80 && wanted.len() > 250);
    if let Some(found) = codes(&cases) {
        assert_eq!(found, wanted);
    }
}

/// A joint turns far along a curve, and squares of the bounds do not fit the narrow integers. At degree 5 the rest is larger
/// than at degree 4, and only the lower one sees the claim: a random world in which one of the checkers tried the higher
/// one alone.
#[test]
fn both_checkers_try_both_degrees_in_wide_integers() {
    let lines = [
        r#"{"receipt":1,"claim":"apart","from":"0x0p0","until":"0x1p0","margin":"0x1.24134bf466a3dp-4"}"#,
        r#"{"base":["0x0p0","0x0p0","0x0p0","0x1.6dc4b5e379ccap-2","-0x1.e84e177944fcbp-4","-0x1.aa93fd66395c4p-10","0x1.da4fa46668258p-1"]}"#,
        r#"{"joint":1,"parent":0,"kind":"turn","origin":["0x0p0","0x0p0","0x0p0","0x0p0","0x0p0","0x0p0","0x1p0"],"axis":["0x1.fbad67b427532p-4","-0x1.eecf1c3818b42p-2","0x1.bbbe374802639p-1"],"drive":[0,"0x1p0","0x0p0"]}"#,
        r#"{"body":0,"name":"link 1","points":[["0x0p0","0x0p0","0x0p0"]],"ellipsoids":[[0,[["0x1.504676ab6595ep-3","0x0p0","0x0p0"],["0x0p0","0x1.0b04c4b625e43p-4","0x0p0"],["0x0p0","0x0p0","0x1.d5c8d9067888p-4"]]]],"link":1}"#,
        r#"{"body":1,"name":"floor","half":[["0x1.078030207928ep-3","-0x1.a4693b63eca1p-4","0x1.f90483c5ae315p-1"],"-0x1.5643dd837ed87p1"],"at":["0x0p0","0x0p0","0x0p0","0x1.873e9723b03b9p-4","-0x1.fc52499f7a7cp-2","0x1.b78044b9a2f25p-1","0x1.652e2ea12fc4dp-4"]}"#,
        r#"{"leg":[["-0x1.2731aefbd5dcp-7"],["0x1.b417f1fb6dd15p-2"],["0x1.cab407479756p-5"],["-0x1.1bd32892e7e45p-2"]]}"#,
        r#"{"plane":[0,1]}"#,
    ];
    let text = sealed(&lines.map(String::from));
    let cases = [(text.clone(), None)];
    assert_eq!(code(&text, None), 0);
    assert!(codes(&cases).is_none_or(|codes| codes == [0]));
}

#[test]
fn lines_that_an_ellipsoid_or_a_half_space_cannot_have_are_refused() {
    let coin = Coin::new(&mut Rng(1));
    let text = coin.receipt([0.0, 0.001], 0.1);
    let lines: Vec<&str> = text.lines().collect();
    let mut cases = vec![(text.clone(), None)];
    for (line, from, to) in [
        (3, "{\"plane\":[0,1]}", "{\"balls\":[0,[1]]}"),
        (3, "[0,1]}", "[0,1],\"normal\":[\"0x0p0\",\"0x0p0\",\"0x1p0\"]}"),
        (
            3,
            "{\"plane\":[0,1]}",
            "{\"outside\":[0,1],\"at\":\"0x0p0\",\"normal\":[\"0x0p0\",\"0x0p0\",\"0x1p0\"]}",
        ),
        (2, "\"ellipsoids\":[[0", "\"ellipsoids\":[[1"),
        (2, "\"ellipsoids\":", "\"faces\":[[0,0,0]],\"ellipsoids\":"),
        (2, "\"ellipsoids\":", "\"radii\":[\"0x0p0\"],\"ellipsoids\":"),
        (2, "\"coin\"", "\"co\u{202e}in\""),
        (2, "\"coin\"", "\"co\u{2028}in\""),
        (1, "\"half\":", "\"radius\":\"0x1p0\",\"half\":"),
        (1, "\"0x1p1\"]", "\"0x0p0\"]"),
    ] {
        assert!(lines[line].contains(from), "{from}: {}", lines[line]);
        let mut changed: Vec<String> = lines[..4].iter().map(|line| (*line).to_owned()).collect();
        changed[line] = changed[line].replacen(from, to, 1);
        cases.push((sealed(&changed), None));
    }
    let ours: Vec<i32> = cases.iter().map(|(text, _)| code(text, None)).collect();
    assert_eq!(ours, [0, 3, 3, 3, 3, 3, 3, 3, 3, 3, 3]);
    if let Some(found) = codes(&cases) {
        assert_eq!(found, ours);
    }
}

/// A small ball below a point and a large one beside it: the distance is that of the small one.
#[test]
fn parts_keep_their_own_radii() {
    let at = |point: V| hexes(&[point[0], point[1], point[2], 0.0, 0.0, 0.0, 1.0]);
    let receipt = |evidence: &str, radii: &str| {
        sealed(&[
            "{\"receipt\":1,\"claim\":\"lines\"}".into(),
            format!(
                "{{\"body\":0,\"name\":\"balls\",\"points\":[{},{}],\"parts\":[[0],[1]],{radii},\"at\":{}}}",
                hexes(&[0.0; 3]),
                hexes(&[4.0, 0.0, 0.0]),
                at([0.0; 3])
            ),
            format!(
                "{{\"body\":1,\"name\":\"point\",\"points\":[{}],\"at\":{}}}",
                hexes(&[0.0; 3]),
                at([0.0, 0.0, 2.0])
            ),
            evidence.into(),
        ])
    };
    let up = hexes(&[0.0, 0.0, 1.0]);
    let aside = hexes(&[-4.0, 0.0, 2.0]);
    let on = "[[[0,\"0x1p0\"]],[[0,\"0x1p0\"]]]";
    let distance = |lower: f64, upper: f64, cells: &str| {
        let [lower, upper] = [lower, upper].map(hex);
        format!("{{\"distance\":[0,1],\"lower\":{lower},\"upper\":{upper},\"cells\":[{cells}],\"on\":{on}}}")
    };
    let near = |within: f64| format!("{{\"near\":[0,1],\"within\":{},\"on\":{on}}}", hex(within));
    let (each, whole) = (format!("[[[0,1]],{up}],[[],{aside}]"), format!("[[],{up}]"));
    let radii = format!("\"radii\":[{},{}]", hex(0.5), hex(1.0));
    let cases = [
        (distance(1.5, 1.5, &each), &*radii, 0),
        (distance(1.5 + 1e-12, 1.6, &each), &*radii, 1),
        (distance(1.0, 1.5 - 1e-12, &each), &*radii, 1),
        // One plane has the greatest radius.
        (distance(1.0, 1.5, &whole), &*radii, 0),
        (distance(1.0 + 1e-12, 1.5, &whole), &*radii, 1),
        (near(1.5), &*radii, 0),
        (near(1.5 - 1e-12), &*radii, 1),
        (near(1.5), "\"radii\":[\"0x1p0\"]", 3),
        (near(1.5), "\"radii\":[\"0x1p0\",\"-0x1p0\"]", 3),
        (near(1.5), "\"radius\":\"0x1p0\",\"radii\":[\"0x1p0\",\"0x1p0\"]", 3),
    ];
    let texts: Vec<(String, Option<String>)> = cases
        .iter()
        .map(|(line, radii, _)| (receipt(line, radii), None))
        .collect();
    let wanted: Vec<i32> = cases.iter().map(|case| case.2).collect();
    let ours: Vec<i32> = texts.iter().map(|(text, _)| code(text, None)).collect();
    assert_eq!(ours, wanted);
    if let Some(found) = codes(&texts) {
        assert_eq!(found, wanted);
    }
}

#[test]
fn points_near_half_spaces_are_proven_as_they_are() {
    let (mut rng, mut cases, mut wanted) = (Rng(9), Vec::new(), Vec::new());
    for k in 0..40 {
        let (point, spin, height) = (rng.vector(1.0), rng.vector(1.0), rng.range(1.0, 2.0));
        let (time, radius) = (rng.range(0.0, 1.0), rng.range(0.0, 0.1));
        let gap = height + turned(scale(spin, time), point)[2] - radius;
        let (zero, identity) = (hexes(&[0.0; 3]), hexes(&REST));
        let mut at = REST;
        at[2] = height;
        // The half-space is first or second, and the body moves or rests.
        let (numbers, moves) = ([[0, 1], [1, 0]][k % 2], k % 4 < 2);
        let gap = if moves { gap } else { height + point[2] - radius };
        let way = format!(
            ",\"steady\":{{\"pivot\":{zero},\"linear\":{zero},\"angular\":{},\"push\":{zero}}}",
            hexes(&spin)
        );
        let mut bodies = [
            format!(
                "{{\"body\":{},\"name\":\"floor\",\"half\":[{},\"0x0p0\"],\"at\":{identity}}}",
                numbers[0],
                hexes(&[0.0, 0.0, 3.0])
            ),
            format!(
                "{{\"body\":{},\"name\":\"pin\",\"points\":[{}],\"radius\":{},\"at\":{}{}}}",
                numbers[1],
                hexes(&point),
                hex(radius),
                hexes(&at),
                if moves { &way } else { "" }
            ),
        ];
        bodies.sort();
        let on = ["[],[[0,\"0x1p0\"]]", "[[0,\"0x1p0\"]],[]"][k % 2];
        for (within, holds) in [(gap + 1e-9, true), (gap - 1e-9, false)] {
            let when = if moves {
                format!(",\"at\":{}", hex(time))
            } else {
                String::new()
            };
            let near = format!("{{\"near\":[0,1],\"within\":{},\"on\":[{on}]{when}}}", hex(within));
            let [first, second] = bodies.clone();
            cases.push((
                sealed(&["{\"receipt\":1,\"claim\":\"lines\"}".into(), first, second, near]),
                None,
            ));
            wanted.push(i32::from(!holds));
        }
    }
    // A half-space has no points.
    let text = cases[0].0.replace("\"on\":[[],", "\"on\":[[[0,\"0x1p0\"]],");
    let lines: Vec<String> = text.lines().take(4).map(String::from).collect();
    cases.push((sealed(&lines), None));
    wanted.push(3);
    let ours: Vec<i32> = cases.iter().map(|(text, _)| code(text, None)).collect();
    assert_eq!(ours, wanted);
    if let Some(found) = codes(&cases) {
        assert_eq!(found, wanted);
    }
}
