// Writes the vertices of bodies into a buffer of vertices: positions between two steps, and normals. Positions and normals of a vertex may
// lie anywhere in it, side by side or apart.

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
    // From 0, the state before the last step, to 1, that after it.
    fraction: f32,
    // Index of the word with the x of the first vertex's position, and of its normal.
    first_position: u32,
    first_normal: u32,
    // Words from a vertex to the next.
    stride: u32,
    // -1 if the faces look inwards in the coordinates of the vertices, else 1.
    orientation: f32,
    // Index of the pair with the particle of the first vertex. None: each particle is a vertex.
    first_vertex: u32,
}

const NONE: u32 = 0xffffffffu;

// First the number of the others; then the body of each workgroup, and the first of its vertices that are written there.
@group(0) @binding(0) var<storage, read> shares: array<vec2u>;
@group(0) @binding(1) var<storage, read> surfaces: array<Surface>;
@group(0) @binding(2) var<storage, read> pairs: array<vec2u>;
@group(0) @binding(3) var<storage, read> before: array<vec4f>;
@group(0) @binding(4) var<storage, read> after: array<vec4f>;
@group(0) @binding(5) var<storage, read_write> vertices: array<f32>;

fn place_of(surface: Surface, index: u32) -> vec3f {
    let particle = surface.first_particle + index;
    let place = mix(before[particle].xyz, after[particle].xyz, surface.fraction) + surface.offset;
    return surface.axis_x * place.x + surface.axis_y * place.y + surface.axis_z * place.z;
}

@compute @workgroup_size(WORKGROUP)
fn write_surface(invocation: Invocation) {
    let thread = invocation.thread;
    let number = number_of(invocation);
    if number >= shares[0].x {
        return;
    }
    let share = shares[number + 1u];
    let surface = surfaces[share.x];
    let index = share.y + thread;
    if index >= surface.vertex_count {
        return;
    }
    var particle = index;
    if surface.first_vertex != NONE {
        particle = pairs[surface.first_vertex + index].x;
        if particle == NONE {
            return;
        }
    }
    let here = place_of(surface, particle);
    var sum = vec3f(0.0);
    let fan = pairs[surface.first_fan + index];
    for (var i = fan.x; i < fan.y; i++) {
        let corners = pairs[surface.first_fan + i];
        if corners.y != NONE {
            sum += cross(place_of(surface, corners.x) - here, place_of(surface, corners.y) - here);
        }
    }
    // Relative to its own size, since the square of a tiny face's area underflows.
    let size = max(max(abs(sum.x), abs(sum.y)), abs(sum.z));
    let normal = select(vec3f(0.0, 0.0, 1.0), normalize(sum / size) * surface.orientation, size > 0.0);
    let position_word = surface.first_position + index * surface.stride;
    let normal_word = surface.first_normal + index * surface.stride;
    let end = arrayLength(&vertices);
    if position_word + 3u > end || normal_word + 3u > end {
        return;
    }
    for (var axis = 0u; axis < 3u; axis++) {
        vertices[position_word + axis] = here[axis];
        vertices[normal_word + axis] = normal[axis];
    }
}
