//! Mouse and picture: the same in a window, on a page and without a display.

use std::sync::Arc;
use std::time::Duration;

use eframe::egui::{self, Color32, FontData, FontDefinitions, FontFamily, PointerButton, Sense, load::SizedTexture};
use eframe::egui_wgpu::{RenderState, wgpu};
use epaint_default_fonts::{HACK_REGULAR, UBUNTU_LIGHT};
use lin_canny::Outcome;
use lin_canny::nalgebra::{Point3, Vector3};
use lin_canny_record::Recording;
use web_time::Instant;

use crate::camera::Camera;
use crate::demo::{self, Demo};
use crate::draw::{DrawList, Show};
use crate::gpu::{Gpu, View};
use crate::panel;
use crate::player::Player;
use crate::stage::Stage;

/// Source of the stage.
pub enum Source {
    /// A recording.
    Recording(Player),
    /// One of the demonstrations, by its number.
    Demo(usize, Box<dyn Demo>),
}

/// The viewer: stage, camera and settings.
pub struct Viewer {
    /// Bodies and pairs.
    pub stage: Stage,
    /// Source of the bodies and pairs.
    pub source: Source,
    /// The camera.
    pub camera: Camera,
    /// What is drawn.
    pub show: Show,
    /// The body picked last.
    pub picked: Option<usize>,
    /// Whether the panel is shown.
    pub panel: bool,
    /// Processor times of the last frame: stage, list, commands.
    pub times: [Duration; 3],
    /// Frames drawn so far.
    pub frames: u64,
    list: DrawList,
    gpu: Gpu,
    texture: Option<egui::TextureId>,
    drag: Option<Drag>,
}

/// What the mouse drags.
enum Drag {
    Camera,
    /// A body, dragged at a depth from the eye.
    Body(usize, f64),
}

impl Viewer {
    /// Returns a viewer that draws one or four samples per pixel; by default four if there is a
    /// graphics card.
    #[must_use]
    pub fn new(context: &egui::Context, state: &RenderState, samples: Option<u32>) -> Self {
        context.set_fonts(fonts());
        context.set_theme(egui::Theme::Light);
        let by_processor = state.adapter.get_info().device_type == wgpu::DeviceType::Cpu;
        let samples = samples.unwrap_or(if by_processor { 1 } else { 4 });
        Self {
            stage: Stage::default(),
            source: Source::Recording(Player::default()),
            camera: Camera::looking_at(Point3::origin(), 6.0),
            show: Show::default(),
            picked: None,
            panel: true,
            times: [Duration::ZERO; 3],
            frames: 0,
            list: DrawList::default(),
            gpu: Gpu::new(&state.device, &state.queue, samples),
            texture: None,
            drag: None,
        }
    }

    /// Opens a recording.
    pub fn open(&mut self, recording: Recording) {
        let (player, stage) = Player::new(recording);
        self.source = Source::Recording(player);
        self.set_stage(stage);
    }

    /// Opens a demonstration by its number in [`demo::NAMES`].
    ///
    /// # Errors
    /// Returns an error if the number does not exist or the bodies cannot be built.
    pub fn open_demo(&mut self, number: usize) -> Result<(), String> {
        let mut stage = Stage::default();
        let demo = demo::open(number, &mut stage)?;
        self.source = Source::Demo(number, demo);
        self.set_stage(stage);
        Ok(())
    }

    fn set_stage(&mut self, stage: Stage) {
        self.gpu.upload(&stage.solids);
        self.stage = stage;
        self.picked = None;
        self.show.all = !matches!(&self.source, Source::Demo(_, demo) if demo.shows_closest_only());
        self.look_at_all();
    }

    /// Moves the camera so that it shows all bodies.
    pub fn look_at_all(&mut self) {
        let (centre, radius) = self.stage.ball();
        self.camera = Camera::looking_at(centre, 3.6 * radius);
    }

    /// Returns the pair of the panel: the closest pair of the picked body, or of all bodies.
    #[must_use]
    pub fn chosen(&self) -> Option<usize> {
        let distance = |k: usize| self.stage.pairs[k].outcome.map_or(f64::INFINITY, |o| o.distance);
        let of_picked = |k: &usize| self.picked.is_none_or(|b| self.stage.pairs[*k].bodies.contains(&b));
        let nearest = |some: &mut dyn Iterator<Item = usize>| some.min_by(|x, y| distance(*x).total_cmp(&distance(*y)));
        let all = 0..self.stage.pairs.len();
        nearest(&mut all.clone().filter(of_picked)).or_else(|| nearest(&mut all.clone()))
    }

    /// Returns the outcome of the chosen pair.
    #[must_use]
    pub fn outcome(&self) -> Option<Outcome> {
        self.stage.pairs[self.chosen()?].outcome
    }

    /// Draws one frame.
    pub fn ui(&mut self, ui: &mut egui::Ui, state: &RenderState) {
        let start = Instant::now();
        let is_held = matches!(self.drag, Some(Drag::Body(..)));
        let moves = match &mut self.source {
            Source::Recording(player) if !is_held => {
                player.advance(&mut self.stage);
                player.plays
            }
            Source::Recording(_) => false,
            Source::Demo(_, demo) => demo.frame(&mut self.stage),
        };
        if self.panel {
            egui::Panel::right("answer")
                .exact_size(280.0)
                .show(ui, |ui| panel::panel(self, ui));
        }
        self.times[0] = start.elapsed();
        egui::CentralPanel::no_frame().show(ui, |ui| self.picture(ui, state));
        if moves {
            ui.ctx().request_repaint();
        }
        self.frames += 1;
    }

    fn picture(&mut self, ui: &mut egui::Ui, state: &RenderState) {
        let (rect, response) = ui.allocate_exact_size(ui.available_size(), Sense::click_and_drag());
        let [width, height] = [f64::from(rect.width()).max(1.0), f64::from(rect.height()).max(1.0)];
        self.mouse(ui, &response, rect, [width, height]);
        let asked = Instant::now();
        let chosen = self.chosen();
        self.list.begin(&self.camera.target);
        self.list.add(&self.stage, &self.show, chosen);
        let listed = Instant::now();
        let scale = ui.ctx().pixels_per_point();
        let [right, up, back] = self.camera.axes();
        let light: Vector3<f64> = (back + right * 0.4 + up * 0.7).normalize();
        let view = View {
            clip: self.camera.clip_from_target(width / height),
            light: light.cast::<f32>().into(),
            size: [width, height].map(|x| (x * f64::from(scale)).round().clamp(1.0, 4096.0) as u32),
            scale,
            origin: self.camera.target,
        };
        let (picture, fresh) = self.gpu.draw(&self.stage, &self.list, &view);
        let texture = register(&mut self.texture, state, picture, fresh);
        egui::Image::from_texture(SizedTexture::new(texture, rect.size())).paint_at(ui, rect);
        self.texts(ui, rect, &view);
        self.times[1] = listed - asked;
        self.times[2] = listed.elapsed();
    }

    /// Draws the names of contacts next to their normals.
    fn texts(&self, ui: &egui::Ui, rect: egui::Rect, view: &View) {
        for (place, text) in &self.list.texts {
            let p = (place - self.camera.target).cast::<f32>();
            let clip = view.clip * p.push(1.0);
            if clip.w > 0.0 {
                let at = egui::vec2(1.0 + clip.x / clip.w, 1.0 - clip.y / clip.w) * 0.5 * rect.size();
                let font = egui::FontId::monospace(11.0);
                let at = rect.min + at + egui::vec2(4.0, 0.0);
                ui.painter()
                    .text(at, egui::Align2::LEFT_CENTER, text, font, Color32::from_gray(40));
            }
        }
    }

    fn mouse(&mut self, ui: &egui::Ui, response: &egui::Response, rect: egui::Rect, size: [f64; 2]) {
        if response.drag_started_by(PointerButton::Primary) || response.clicked() {
            self.press(ui, rect, size);
        }
        let by = response.drag_delta();
        let (dx, dy) = (f64::from(by.x), f64::from(by.y));
        if response.dragged_by(PointerButton::Primary) {
            match self.drag {
                Some(Drag::Body(body, depth)) => {
                    let along = self.camera.in_plane(dx, dy, depth, size[1]);
                    self.stage.bodies[body].pose.translation.vector += along;
                    self.stage.moved(body);
                }
                _ => self.camera.orbit(dx, dy),
            }
        } else if response.dragged_by(PointerButton::Secondary) {
            self.camera.pan(dx, dy, size[1]);
        }
        if response.drag_stopped() || response.clicked() {
            self.drag = None;
        }
        if response.hovered() {
            let (wheel, pinch) = ui.input(|i| (i.smooth_scroll_delta.y, i.zoom_delta()));
            self.camera.zoom(f64::from((-0.002 * wheel).exp() / pinch));
        }
    }

    fn press(&mut self, ui: &egui::Ui, rect: egui::Rect, [width, height]: [f64; 2]) {
        let origin = ui.input(|i| i.pointer.press_origin().or(i.pointer.interact_pos()));
        let at = origin.unwrap_or(rect.center()) - rect.center();
        let (x, y) = (2.0 * f64::from(at.x) / width, -2.0 * f64::from(at.y) / height);
        let (eye, along) = self.camera.ray(x, y, width / height);
        let hit = self.stage.pick(&eye, &along);
        self.picked = hit.map(|(body, _)| body);
        let held = |body| match &self.source {
            Source::Recording(_) => true,
            Source::Demo(_, demo) => demo.may_hold(body),
        };
        self.drag = Some(match hit {
            Some((body, far)) if held(body) => Drag::Body(body, self.camera.depth(&(eye + along * far))),
            _ => Drag::Camera,
        });
    }
}

/// Registers the texture in egui and returns its id.
fn register(
    known: &mut Option<egui::TextureId>,
    state: &RenderState,
    picture: &wgpu::TextureView,
    fresh: bool,
) -> egui::TextureId {
    let mut renderer = state.renderer.write();
    let filter = wgpu::FilterMode::Nearest;
    match *known {
        Some(texture) => {
            if fresh {
                renderer.update_egui_texture_from_wgpu_texture(&state.device, picture, filter, texture);
            }
            texture
        }
        None => *known.insert(renderer.register_native_texture(&state.device, picture, filter)),
    }
}

/// Returns two fonts. The other two fonts of egui, for emoji, would add 0.7 MB to the page.
fn fonts() -> FontDefinitions {
    let mut fonts = FontDefinitions::empty();
    for (family, data) in [
        (FontFamily::Proportional, UBUNTU_LIGHT),
        (FontFamily::Monospace, HACK_REGULAR),
    ] {
        let name = family.to_string();
        fonts
            .font_data
            .insert(name.clone(), Arc::new(FontData::from_static(data)));
        fonts.families.insert(family, vec![name]);
    }
    fonts
}

impl eframe::App for Viewer {
    fn ui(&mut self, ui: &mut egui::Ui, frame: &mut eframe::Frame) {
        if let Some(state) = frame.wgpu_render_state() {
            Viewer::ui(self, ui, state);
        }
    }

    #[cfg(target_arch = "wasm32")]
    fn as_any_mut(&mut self) -> Option<&mut dyn std::any::Any> {
        Some(self)
    }
}
