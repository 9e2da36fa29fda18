// The vertices of bodies in a buffer of vertices: positions between two steps, and normals. Positions and normals of a vertex may lie anywhere
// in it, side by side or apart.

struct Surface {
    // Columns of the matrix that turns the body's coordinates into those of the vertices.
    axis_x: vec3f,
    first_particle: u32,
    axis_y: vec3f,
    vertex_count: u32,
    axis_z: vec3f,
    first_fan: u32,
    // Added to a position before it is turned.
    offset: vec3f,
    // -1 if the faces look inwards in the coordinates of the vertices, else 1.
    orientation: f32,
    // Index of the word with the x of the first vertex's position, and of its normal.
    first_position: u32,
    first_normal: u32,
    // Words from a vertex to the next.
    stride: u32,
    // Index of the pair with the particle of the first vertex, or ring. None: each particle is a vertex.
    first_vertex: u32,
    // Of a tube: its radius, and the numbers of its rings and of their corners.
    radius: f32,
    ring_count: u32,
    sides: u32,
}

const NONE: u32 = 0xffffffffu;

// First the number of the other entries, and the bits of a fraction: 0 is the state before the last step, 1 that after it. Then for each workgroup a surface,
// and the first of its vertices that are written there.
@group(0) @binding(0) var<storage, read> shares: array<vec2u>;
@group(0) @binding(1) var<storage, read> surfaces: array<Surface>;
@group(0) @binding(2) var<storage, read> pairs: array<vec2u>;
@group(0) @binding(3) var<storage, read> before: array<vec4f>;
@group(0) @binding(4) var<storage, read> after: array<vec4f>;
@group(0) @binding(5) var<storage, read_write> vertices: array<f32>;

fn place_of(surface: Surface, index: u32) -> vec3f {
    let particle = surface.first_particle + index;
    let fraction = bitcast<f32>(shares[0].y);
    let place = mix(before[particle].xyz, after[particle].xyz, fraction) + surface.offset;
    return surface.axis_x * place.x + surface.axis_y * place.y + surface.axis_z * place.z;
}

fn write_vertex(surface: Surface, index: u32, place: vec3f, normal: vec3f) {
    let position_word = surface.first_position + index * surface.stride;
    let normal_word = surface.first_normal + index * surface.stride;
    let end = arrayLength(&vertices);
    if position_word + 3u > end || normal_word + 3u > end {
        return;
    }
    for (var axis = 0u; axis < 3u; axis++) {
        vertices[position_word + axis] = place[axis];
        vertices[normal_word + axis] = normal[axis];
    }
}

// The direction of a vector, whose square may underflow; zero if it has none.
fn direction_of(vector: vec3f) -> vec3f {
    let size = max(max(abs(vector.x), abs(vector.y)), abs(vector.z));
    return select(vec3f(0.0), normalize(vector / size), size > 0.0);
}
