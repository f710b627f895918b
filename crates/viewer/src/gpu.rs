//! Draws bodies and a list into a texture, independent of windows.
//!
//! Triangles and edges of all geometries are in one buffer each, written once. A frame sends a
//! matrix and a colour for each body.

use eframe::egui_wgpu::wgpu;
use lin_canny::nalgebra::{Matrix4, Point3};
use lin_canny_record::RenderMesh;

use crate::draw::{CORNER_WORDS, DrawList, STROKE_WORDS};
use crate::pipelines::{INSTANCE_WORDS, Pipelines, RIM_WORDS};
use crate::stage::Stage;

/// Colours are written as displayed: egui works in gamma space.
pub(crate) const COLOUR: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;
pub(crate) const DEPTH: wgpu::TextureFormat = wgpu::TextureFormat::Depth24Plus;
const BACKGROUND: wgpu::Color = wgpu::Color {
    r: 0.93,
    g: 0.94,
    b: 0.96,
    a: 1.0,
};

/// Pipelines and buffers.
pub struct Gpu {
    device: wgpu::Device,
    queue: wgpu::Queue,
    pipelines: Pipelines,
    meshes: Vec<Ranges>,
    triangles: Growing,
    edges: Growing,
    instances: Growing,
    corners: Growing,
    strokes: Growing,
    marks: Growing,
    target: Option<Target>,
    samples: u32,
    words: Vec<u32>,
}

/// Range of a geometry in the buffers, in vertices.
struct Ranges {
    triangles: std::ops::Range<u32>,
    edges: std::ops::Range<u32>,
}

/// The textures of one size.
struct Target {
    size: [u32; 2],
    picture: wgpu::TextureView,
    samples: Option<wgpu::TextureView>,
    depth: wgpu::TextureView,
}

/// The camera of a frame.
pub struct View {
    /// Map from the world, with the target of the camera as its origin, to clip space.
    pub clip: Matrix4<f32>,
    /// Unit direction to the light.
    pub light: [f32; 3],
    /// Size in pixels.
    pub size: [u32; 2],
    /// Pixels per point of the screen.
    pub scale: f32,
    /// The target of the camera.
    pub origin: Point3<f64>,
}

impl Gpu {
    /// Uses one or four samples per pixel: every driver supports both.
    #[must_use]
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue, samples: u32) -> Self {
        Self {
            pipelines: Pipelines::new(device, samples),
            meshes: Vec::new(),
            triangles: Growing::default(),
            edges: Growing::default(),
            instances: Growing::default(),
            corners: Growing::default(),
            strokes: Growing::default(),
            marks: Growing::default(),
            target: None,
            samples,
            words: Vec::new(),
            device: device.clone(),
            queue: queue.clone(),
        }
    }

    /// Uploads the geometries of another stage.
    pub fn upload(&mut self, solids: &[RenderMesh]) {
        let (mut triangles, mut edges) = (Vec::new(), Vec::new());
        let push = |words: &mut Vec<u32>, p: [f64; 3]| words.extend(p.map(|x| (x as f32).to_bits()));
        self.meshes.clear();
        for solid in solids {
            let first = [triangles.len() / 6, edges.len() / RIM_WORDS];
            for (corners, normal) in &solid.triangles {
                for corner in corners {
                    push(&mut triangles, (*corner).into());
                    push(&mut triangles, (*normal).into());
                }
            }
            for end in solid.edges.iter().flatten() {
                push(&mut edges, (*end).into());
            }
            self.meshes.push(Ranges {
                triangles: first[0] as u32..(triangles.len() / 6) as u32,
                edges: first[1] as u32..(edges.len() / RIM_WORDS) as u32,
            });
        }
        self.triangles.fill(&self.device, &self.queue, &triangles);
        self.edges.fill(&self.device, &self.queue, &edges);
    }

    /// Writes the instances, ordered by geometry; returns where each geometry's instances start and
    /// end.
    fn place(&mut self, stage: &Stage, origin: &Point3<f64>) -> Vec<u32> {
        let mut ends = vec![0u32; self.meshes.len() + 1];
        let shown = || stage.bodies.iter().filter(|b| b.shown);
        shown().for_each(|b| ends[b.geometry + 1] += 1);
        for k in 1..ends.len() {
            ends[k] += ends[k - 1];
        }
        let mut next = ends.clone();
        self.words.resize(ends[self.meshes.len()] as usize * INSTANCE_WORDS, 0);
        for body in shown() {
            let slot = next[body.geometry] as usize;
            next[body.geometry] += 1;
            let turn = body.pose.rotation.to_rotation_matrix();
            let words = &mut self.words[slot * INSTANCE_WORDS..][..INSTANCE_WORDS];
            for row in 0..3 {
                for column in 0..3 {
                    words[4 * row + column] = (turn[(row, column)] as f32).to_bits();
                }
                let along = body.pose.translation.vector[row] - origin[row];
                words[4 * row + 3] = (along as f32).to_bits();
            }
            words[12] = u32::from_le_bytes(body.colour);
        }
        self.instances.fill(&self.device, &self.queue, &self.words);
        ends
    }

    /// Draws, and returns the picture and whether its texture differs from that of the last call.
    pub fn draw(&mut self, stage: &Stage, list: &DrawList, view: &View) -> (&wgpu::TextureView, bool) {
        let fresh = self.target.as_ref().is_none_or(|t| t.size != view.size);
        let target = match self.target.take() {
            Some(target) if !fresh => target,
            _ => Target::new(&self.device, view.size, self.samples),
        };
        self.pipelines.look(&self.queue, view);
        let ends = self.place(stage, &view.origin);
        self.corners.fill(&self.device, &self.queue, &list.corners);
        self.strokes.fill(&self.device, &self.queue, &list.strokes);
        self.marks.fill(&self.device, &self.queue, &list.marks);
        let mut encoder = self.device.create_command_encoder(&Default::default());
        {
            let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some("scene"),
                color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                    view: target.samples.as_ref().unwrap_or(&target.picture),
                    depth_slice: None,
                    resolve_target: target.samples.as_ref().map(|_| &target.picture),
                    ops: wgpu::Operations {
                        load: wgpu::LoadOp::Clear(BACKGROUND),
                        store: match target.samples {
                            Some(_) => wgpu::StoreOp::Discard,
                            None => wgpu::StoreOp::Store,
                        },
                    },
                })],
                depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                    view: &target.depth,
                    depth_ops: Some(wgpu::Operations {
                        load: wgpu::LoadOp::Clear(1.0),
                        store: wgpu::StoreOp::Discard,
                    }),
                    stencil_ops: None,
                }),
                ..Default::default()
            });
            self.pipelines.bind(&mut pass);
            self.bodies(&mut pass, &ends);
            self.strokes(&mut pass, &self.strokes, &self.pipelines.hidden, &list.strokes);
            if let Some(buffer) = self.corners.filled() {
                pass.set_pipeline(&self.pipelines.fill);
                pass.set_vertex_buffer(0, buffer);
                pass.draw(0..(list.corners.len() / CORNER_WORDS) as u32, 0..1);
            }
            self.strokes(&mut pass, &self.marks, &self.pipelines.through, &list.marks);
        }
        self.queue.submit([encoder.finish()]);
        (&self.target.insert(target).picture, fresh)
    }

    fn bodies(&self, pass: &mut wgpu::RenderPass<'_>, ends: &[u32]) {
        let Some(instances) = &self.instances.buffer else {
            return;
        };
        let stages = [
            (&self.pipelines.solid, &self.triangles, true),
            (&self.pipelines.rim, &self.edges, false),
        ];
        for (pipeline, vertices, is_solid) in stages {
            let Some(vertices) = vertices.filled() else { continue };
            pass.set_pipeline(pipeline);
            pass.set_vertex_buffer(0, vertices);
            for (mesh, slots) in self.meshes.iter().zip(ends.windows(2)) {
                let range = if is_solid { &mesh.triangles } else { &mesh.edges };
                if slots[0] < slots[1] && !range.is_empty() {
                    // The slice starts at the first instance, because WebGL 2 supports only 0 as
                    // the first instance.
                    let stride = 4 * INSTANCE_WORDS as u64;
                    let [from, to] = [slots[0], slots[1]].map(|k| u64::from(k) * stride);
                    pass.set_vertex_buffer(1, instances.slice(from..to));
                    pass.draw(range.clone(), 0..slots[1] - slots[0]);
                }
            }
        }
    }

    fn strokes(&self, pass: &mut wgpu::RenderPass<'_>, from: &Growing, by: &wgpu::RenderPipeline, words: &[u32]) {
        if let Some(buffer) = from.filled() {
            pass.set_pipeline(by);
            pass.set_vertex_buffer(0, buffer);
            pass.draw(0..4, 0..(words.len() / STROKE_WORDS) as u32);
        }
    }
}

impl Target {
    fn new(device: &wgpu::Device, size: [u32; 2], samples: u32) -> Self {
        let texture = |format, sample_count, usage| {
            let texture = device.create_texture(&wgpu::TextureDescriptor {
                label: None,
                size: wgpu::Extent3d {
                    width: size[0],
                    height: size[1],
                    depth_or_array_layers: 1,
                },
                mip_level_count: 1,
                sample_count,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage: wgpu::TextureUsages::RENDER_ATTACHMENT | usage,
                view_formats: &[],
            });
            texture.create_view(&Default::default())
        };
        Self {
            size,
            picture: texture(COLOUR, 1, wgpu::TextureUsages::TEXTURE_BINDING),
            samples: (samples > 1).then(|| texture(COLOUR, samples, wgpu::TextureUsages::empty())),
            depth: texture(DEPTH, samples, wgpu::TextureUsages::empty()),
        }
    }
}

/// A vertex buffer that is replaced by a larger one if it is too small.
#[derive(Default)]
struct Growing {
    buffer: Option<wgpu::Buffer>,
    bytes: u64,
}

impl Growing {
    fn fill(&mut self, device: &wgpu::Device, queue: &wgpu::Queue, words: &[u32]) {
        self.bytes = 4 * words.len() as u64;
        if self.buffer.as_ref().is_none_or(|b| b.size() < self.bytes) {
            self.buffer = Some(device.create_buffer(&wgpu::BufferDescriptor {
                label: None,
                size: self.bytes.next_power_of_two().max(1 << 12),
                usage: wgpu::BufferUsages::VERTEX | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            }));
        }
        if let Some(buffer) = self.buffer.as_ref().filter(|_| !words.is_empty()) {
            queue.write_buffer(buffer, 0, bytemuck::cast_slice(words));
        }
    }

    fn filled(&self) -> Option<wgpu::BufferSlice<'_>> {
        self.buffer
            .as_ref()
            .filter(|_| self.bytes > 0)
            .map(|b| b.slice(..self.bytes))
    }
}
