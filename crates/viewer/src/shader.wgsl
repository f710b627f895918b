// Bodies, placed by a matrix of three rows; flat triangles; and strokes of a width in pixels with round ends. A stroke of no length is a disc.

struct View {
    clip: mat4x4<f32>,
    light: vec4<f32>,
    size: vec2<f32>,
    pixel: vec2<f32>, // x: pixels of a point
}
@group(0) @binding(0) var<uniform> view: View;

struct Corner {
    @builtin(position) clip: vec4<f32>,
    @location(0) @interpolate(flat) colour: vec4<f32>,
}

@vertex
fn solid(
    @location(0) position: vec3<f32>,
    @location(1) normal: vec3<f32>,
    @location(2) x: vec4<f32>,
    @location(3) y: vec4<f32>,
    @location(4) z: vec4<f32>,
    @location(5) colour: vec4<f32>,
) -> Corner {
    let p = vec4(position, 1.0);
    let n = vec4(normal, 0.0);
    let facing = dot(vec3(dot(x, n), dot(y, n), dot(z, n)), view.light.xyz);
    let shade = 0.62 + 0.38 * facing;
    return Corner(view.clip * vec4(dot(x, p), dot(y, p), dot(z, p), 1.0), vec4(colour.rgb * shade, colour.a));
}

@vertex
fn rim(
    @location(0) position: vec3<f32>,
    @location(2) x: vec4<f32>,
    @location(3) y: vec4<f32>,
    @location(4) z: vec4<f32>,
    @location(5) colour: vec4<f32>,
) -> Corner {
    let p = vec4(position, 1.0);
    var clip = view.clip * vec4(dot(x, p), dot(y, p), dot(z, p), 1.0);
    clip.z -= 6e-5 * clip.w;
    return Corner(clip, vec4(colour.rgb * 0.33, colour.a));
}

@vertex
fn corner(@location(0) position: vec3<f32>, @location(1) normal: vec3<f32>, @location(2) colour: vec4<f32>) -> Corner {
    let facing = dot(normal, view.light.xyz);
    let shade = 0.8 + 0.2 * facing;
    var clip = view.clip * vec4(position, 1.0);
    clip.z -= 3e-5 * clip.w;
    return Corner(clip, vec4(colour.rgb * shade, colour.a));
}

@fragment
fn fill(in: Corner) -> @location(0) vec4<f32> {
    return in.colour;
}

struct Stroke {
    @builtin(position) clip: vec4<f32>,
    @location(0) @interpolate(flat) colour: vec4<f32>,
    // Along and across in pixels, and one, all times w: the quotient is linear on the screen.
    @location(1) place: vec3<f32>,
    @location(2) @interpolate(flat) shape: vec2<f32>, // length, radius
}

@vertex
fn stroke(
    @builtin(vertex_index) index: u32,
    @location(0) from_end: vec3<f32>,
    @location(1) to_end: vec3<f32>,
    @location(2) colour: vec4<f32>,
    @location(3) width: f32,
) -> Stroke {
    var a = view.clip * vec4(from_end, 1.0);
    var b = view.clip * vec4(to_end, 1.0);
    // What lies behind the eye is cut off.
    let near = 1e-3;
    if a.w < near && b.w > near { a = mix(a, b, (near - a.w) / (b.w - a.w)); }
    if b.w < near && a.w > near { b = mix(b, a, (near - b.w) / (a.w - b.w)); }
    let half = 0.5 * view.size;
    let p = a.xy / a.w * half;
    let q = b.xy / b.w * half;
    let span = length(q - p);
    var along = vec2(1.0, 0.0);
    if span > 1e-3 { along = (q - p) / span; }
    let radius = 0.5 * width * view.pixel.x;
    let reach = radius + 1.0;
    let at_end = (index & 1u) == 1u;
    let s = select(-reach, span + reach, at_end);
    let t = select(-reach, reach, (index & 2u) == 2u);
    let place = (p + along * s + vec2(-along.y, along.x) * t) / half;
    var end = a;
    if at_end { end = b; }
    let w = end.w;
    return Stroke(
        vec4(place * w, end.z - 4e-5 * w, w),
        colour,
        vec3(s, t, 1.0) * w,
        vec2(span, radius),
    );
}

@fragment
fn ink(in: Stroke) -> @location(0) vec4<f32> {
    let place = in.place.xy / in.place.z;
    let beyond = place.x - clamp(place.x, 0.0, in.shape.x);
    let cover = clamp(in.shape.y + 0.5 - length(vec2(beyond, place.y)), 0.0, 1.0);
    return vec4(in.colour.rgb, in.colour.a * cover);
}
