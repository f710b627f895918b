//! A recording as a page: one HTML file that holds everything and needs no network.
//!
//! Rust computes what is drawn (triangles, features, texts), and the script of `page.html` draws it.

mod data;
mod feature;

use crate::markup::escaped;
use crate::read::Recording;

const TEMPLATE: &str = include_str!("page.html");

/// Options of [`page`].
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct PageOptions {
    /// The frame that the page shows first, or the last frame if the number is larger.
    pub frame: usize,
    /// Yaw and pitch of the camera in radians, and its distance as a fraction of the distance that
    /// shows all bodies.
    pub view: [f64; 3],
    /// Whether the panel with the answers and the switches is open at first.
    pub panel: bool,
    /// Red, green and blue of bodies, by number. Further bodies have the colours of a palette.
    pub colors: Vec<[u8; 3]>,
}

impl Default for PageOptions {
    fn default() -> Self {
        Self {
            frame: 0,
            view: [-1.1, 0.45, 1.0],
            panel: true,
            colors: Vec::new(),
        }
    }
}

impl PageOptions {
    /// Sets the frame that the page shows first.
    #[must_use]
    pub fn frame(mut self, frame: usize) -> Self {
        self.frame = frame;
        self
    }

    /// Sets yaw, pitch and distance of the camera.
    #[must_use]
    pub fn view(mut self, view: [f64; 3]) -> Self {
        self.view = view;
        self
    }

    /// Sets whether the panel is open at first.
    #[must_use]
    pub fn panel(mut self, panel: bool) -> Self {
        self.panel = panel;
        self
    }

    /// Sets the colours of bodies, by number.
    #[must_use]
    pub fn colors(mut self, colors: Vec<[u8; 3]>) -> Self {
        self.colors = colors;
        self
    }
}

/// Returns a page that plays a recording: one HTML file that needs no server and no network.
///
/// The page draws bodies, closest points with their features and Voronoi regions, contacts, boxes,
/// columns, brackets and paths. Drag to rotate, drag with the right button or Shift to shift, use
/// the wheel to zoom. A slider chooses the frame, and a click on a body shows the answer about its
/// closest pair. The browser needs WebGL 2.
///
/// The part of an address after `#` overrides the options, joined by `&`: `frame=20`,
/// `view=YAW,PITCH,NEAR`, `panel=0`, `bare` (the picture alone), and `regions=1`, `boxes=1`,
/// `columns=1`, `names=0`, `witnesses=0`, `all=0`, `contacts=0`, `brackets=0`, `paths=0`.
///
/// ```
/// use lin_canny_record::{PageOptions, Recording, page};
///
/// let lines = "{\"format\":\"lin-canny recording\",\"version\":2,\"title\":\"empty\"}\n";
/// let recording = Recording::read(lines.as_bytes())?;
/// let html = page(&recording, &PageOptions::default());
/// assert!(html.contains("<title>empty</title>"));
/// # Ok::<(), lin_canny_record::ReadError>(())
/// ```
#[must_use]
pub fn page(recording: &Recording, options: &PageOptions) -> String {
    let data = data::Data::new(recording, options);
    // Numbers that are not finite become null, so that this cannot fail.
    let data = serde_json::to_string(&data).unwrap_or_default();
    let (head, tail) = TEMPLATE.split_once("@DATA@").unwrap_or((TEMPLATE, ""));
    // No text can end the script that holds the data.
    head.replace("@TITLE@", &escaped(&recording.title)) + &data.replace('<', "\\u003c") + tail
}
