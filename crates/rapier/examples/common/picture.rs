//! Pictures of hulls: each visible face filled, far bodies first.

use lin_canny_rapier::lin_canny_parry::lin_canny::ConvexPolyhedron;
use lin_canny_rapier::lin_canny_parry::lin_canny::nalgebra::{Isometry3, Vector3};
use lin_canny_record::svg::{Place, Svg, View};

/// Returns a view of a scene, in which y is up, from an angle above the horizon and an angle about
/// the vertical, in radians. The scale is in pixels per unit of length.
pub(crate) fn view(origin: Place, scale: f64, above: f64, about: f64) -> View {
    let ((s, c), (t, d)) = (about.sin_cos(), above.sin_cos());
    View::new(&Vector3::new(d * s, t, d * c), &Vector3::y(), scale, origin)
}

/// A body to be drawn.
pub(crate) struct Drawn<'a> {
    pub(crate) body: &'a ConvexPolyhedron,
    pub(crate) pose: Isometry3<f64>,
    pub(crate) color: [f64; 3],
}

/// Draws bodies, those far from the reader first; what falls off a page of a size is left out.
pub(crate) fn hulls(svg: &mut Svg, size: [f64; 2], view: &View, bodies: &[Drawn]) {
    let mut order: Vec<&Drawn> = bodies.iter().collect();
    let near = |d: &Drawn| view.depth(&(d.pose * d.body.centroid()));
    order.sort_by(|x, y| near(x).total_cmp(&near(y)));
    for d in order {
        for f in d.body.faces() {
            let Some((n, _)) = d.body.face_plane(f) else { continue };
            let n = d.pose.rotation * n.into_inner();
            let rim = d.body.face_vertices(f).filter_map(|v| d.body.vertex(v));
            let rim: Vec<Place> = rim.map(|p| view.place(&(d.pose * p))).collect();
            let on_page = |p: &Place| (0..2).all(|k| (0.0..=size[k]).contains(&p[k]));
            if n.dot(&view.axes[2]) > 0.0 && rim.iter().all(on_page) {
                let light = Vector3::new(-0.4, 0.8, 0.45).normalize();
                let shade = 0.55 + 0.45 * n.dot(&light).max(0.0);
                let [r, g, b] = d.color.map(|c| (255.0 * c * shade) as u8);
                let color = format!("#{r:02x}{g:02x}{b:02x}");
                svg.polygon(
                    &rim,
                    &format!("fill=\"{color}\" stroke=\"{color}\" stroke-width=\"0.5\""),
                );
            }
        }
    }
}

/// Colours of Okabe and Ito 2008.
pub(crate) const BLUE: [f64; 3] = [0.0, 0.45, 0.70];
pub(crate) const ORANGE: [f64; 3] = [0.90, 0.45, 0.05];
pub(crate) const GREY: [f64; 3] = [0.80, 0.82, 0.84];
