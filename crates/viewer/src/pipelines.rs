//! The pipelines: bodies, their edges, triangles and strokes.

use eframe::egui_wgpu::wgpu;

use crate::draw::{CORNER_WORDS, STROKE_WORDS};
use crate::gpu::{COLOUR, DEPTH, View};

/// Words of an instance of a body: three rows of a matrix, and a colour.
pub(crate) const INSTANCE_WORDS: usize = 13;

/// Words of an end of an edge.
pub(crate) const RIM_WORDS: usize = 3;

/// Words of the uniform `View`.
const VIEW_WORDS: usize = 24;

/// All pipelines, and the uniform that they share.
pub(crate) struct Pipelines {
    pub(crate) solid: wgpu::RenderPipeline,
    pub(crate) rim: wgpu::RenderPipeline,
    pub(crate) fill: wgpu::RenderPipeline,
    pub(crate) hidden: wgpu::RenderPipeline,
    pub(crate) through: wgpu::RenderPipeline,
    view: wgpu::Buffer,
    group: wgpu::BindGroup,
}

impl Pipelines {
    pub(crate) fn new(device: &wgpu::Device, samples: u32) -> Self {
        let (view, layout, group) = uniform(device);
        let maker = Maker {
            device,
            samples,
            shader: &device.create_shader_module(wgpu::include_wgsl!("shader.wgsl")),
            layout: &device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                label: None,
                bind_group_layouts: &[Some(&layout)],
                immediate_size: 0,
            }),
        };
        let body = wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3];
        let end = wgpu::vertex_attr_array![0 => Float32x3];
        let place = wgpu::vertex_attr_array![2 => Float32x4, 3 => Float32x4, 4 => Float32x4, 5 => Unorm8x4];
        let corner = wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3, 2 => Unorm8x4];
        let stroke = wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3, 2 => Unorm8x4, 3 => Float32];
        let each = |attributes, words| layout_of(attributes, words, wgpu::VertexStepMode::Vertex);
        let per = |attributes, words| layout_of(attributes, words, wgpu::VertexStepMode::Instance);
        let bodies = [each(&body, 6), per(&place, INSTANCE_WORDS)];
        let rims = [each(&end, RIM_WORDS), per(&place, INSTANCE_WORDS)];
        let strokes = [per(&stroke, STROKE_WORDS)];
        use wgpu::CompareFunction::{Always, Less};
        use wgpu::PrimitiveTopology::{LineList, TriangleList, TriangleStrip};
        Self {
            solid: maker.make(["solid", "fill"], &bodies, TriangleList, Less, true),
            rim: maker.make(["rim", "fill"], &rims, LineList, Less, false),
            fill: maker.make(
                ["corner", "fill"],
                &[each(&corner, CORNER_WORDS)],
                TriangleList,
                Less,
                false,
            ),
            hidden: maker.make(["stroke", "ink"], &strokes, TriangleStrip, Less, false),
            through: maker.make(["stroke", "ink"], &strokes, TriangleStrip, Always, false),
            view,
            group,
        }
    }

    /// Sends the camera of a frame.
    pub(crate) fn look(&self, queue: &wgpu::Queue, view: &View) {
        let mut words = [0f32; VIEW_WORDS];
        words[..16].copy_from_slice(view.clip.as_slice());
        words[16..19].copy_from_slice(&view.light);
        words[20..23].copy_from_slice(&[view.size[0] as f32, view.size[1] as f32, view.scale]);
        queue.write_buffer(&self.view, 0, bytemuck::cast_slice(&words));
    }

    pub(crate) fn bind(&self, pass: &mut wgpu::RenderPass<'_>) {
        pass.set_bind_group(0, &self.group, &[]);
    }
}

fn layout_of(
    attributes: &[wgpu::VertexAttribute],
    words: usize,
    step_mode: wgpu::VertexStepMode,
) -> Option<wgpu::VertexBufferLayout<'_>> {
    Some(wgpu::VertexBufferLayout {
        array_stride: 4 * words as u64,
        step_mode,
        attributes,
    })
}

fn uniform(device: &wgpu::Device) -> (wgpu::Buffer, wgpu::BindGroupLayout, wgpu::BindGroup) {
    let view = device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("view"),
        size: 4 * VIEW_WORDS as u64,
        usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: None,
        entries: &[wgpu::BindGroupLayoutEntry {
            binding: 0,
            visibility: wgpu::ShaderStages::VERTEX,
            ty: wgpu::BindingType::Buffer {
                ty: wgpu::BufferBindingType::Uniform,
                has_dynamic_offset: false,
                min_binding_size: None,
            },
            count: None,
        }],
    });
    let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: None,
        layout: &layout,
        entries: &[wgpu::BindGroupEntry {
            binding: 0,
            resource: view.as_entire_binding(),
        }],
    });
    (view, layout, group)
}

/// Shared parameters for creating the pipelines.
struct Maker<'a> {
    device: &'a wgpu::Device,
    samples: u32,
    shader: &'a wgpu::ShaderModule,
    layout: &'a wgpu::PipelineLayout,
}

impl Maker<'_> {
    fn make(
        &self,
        [vertex, fragment]: [&str; 2],
        buffers: &[Option<wgpu::VertexBufferLayout<'_>>],
        topology: wgpu::PrimitiveTopology,
        compare: wgpu::CompareFunction,
        is_solid: bool,
    ) -> wgpu::RenderPipeline {
        self.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some(vertex),
            layout: Some(self.layout),
            vertex: wgpu::VertexState {
                module: self.shader,
                entry_point: Some(vertex),
                compilation_options: Default::default(),
                buffers,
            },
            primitive: wgpu::PrimitiveState {
                topology,
                cull_mode: is_solid.then_some(wgpu::Face::Back),
                ..Default::default()
            },
            depth_stencil: Some(wgpu::DepthStencilState {
                format: DEPTH,
                depth_write_enabled: Some(is_solid),
                depth_compare: Some(compare),
                stencil: Default::default(),
                bias: Default::default(),
            }),
            multisample: wgpu::MultisampleState {
                count: self.samples,
                ..Default::default()
            },
            fragment: Some(wgpu::FragmentState {
                module: self.shader,
                entry_point: Some(fragment),
                compilation_options: Default::default(),
                targets: &[Some(wgpu::ColorTargetState {
                    format: COLOUR,
                    blend: (!is_solid).then_some(wgpu::BlendState::ALPHA_BLENDING),
                    write_mask: wgpu::ColorWrites::COLOR,
                })],
            }),
            multiview_mask: None,
            cache: None,
        })
    }
}
