// Writes tubes around ropes. One workgroup takes a rope, and as many rings at a time as it has threads:
//
//     each thread   the centre of a ring, and the direction of the rope there
//     one thread    the vector across each ring: that of the ring before, turned only as far as the rope bends (parallel transport)
//     each thread   corners of all these rings
//
// The vector across the first ring is the normal of the tube's first vertex. It stays from frame to frame, so that the tube does not spin.

var<workgroup> centres: array<vec3f, WORKGROUP>;
var<workgroup> tangents: array<vec3f, WORKGROUP>;
var<workgroup> acrosses: array<vec3f, WORKGROUP>;

fn centre_of(surface: Surface, ring: u32) -> vec3f {
    return place_of(surface, pairs[surface.first_vertex + ring].x);
}

// The mean direction of both links at a ring; zero if there is none.
fn tangent_of(surface: Surface, ring: u32, centre: vec3f) -> vec3f {
    var sum = vec3f(0.0);
    if ring > 0u {
        sum += direction_of(centre - centre_of(surface, ring - 1u));
    }
    if ring + 1u < surface.ring_count {
        sum += direction_of(centre_of(surface, ring + 1u) - centre);
    }
    return direction_of(sum);
}

// Turns `vector` as the shortest rotation turns one direction into another (Rodrigues' formula, without angles).
fn transported(vector: vec3f, tail: vec3f, head: vec3f) -> vec3f {
    let cosine = dot(tail, head);
    let axis = cross(tail, head);
    return vector * cosine + cross(axis, vector) + axis * (dot(axis, vector) / (1.0 + cosine));
}

// The direction nearest to `vector` that is across `tangent`; if there is none, any one, as the processor chooses it (Duff et al. 2017, "Building an
// orthonormal basis, revisited").
fn across_from(vector: vec3f, tangent: vec3f) -> vec3f {
    let nearest = vector - tangent * dot(vector, tangent);
    // What rounding leaves of a vector along the tangent has no direction. Comparisons with what is no number fail.
    if dot(nearest, nearest) > 1e-8 * dot(vector, vector) {
        return normalize(nearest);
    }
    let side = select(-1.0, 1.0, tangent.z >= 0.0);
    let a = -1.0 / (side + tangent.z);
    return vec3f(tangent.x * tangent.y * a, side + tangent.y * tangent.y * a, -tangent.y);
}

// The vector that the rings start from, as it was written last, or whatever the buffer held.
fn last_across(surface: Surface) -> vec3f {
    let word = surface.first_normal;
    if word + 3u > arrayLength(&vertices) {
        return vec3f(0.0);
    }
    return vec3f(vertices[word], vertices[word + 1u], vertices[word + 2u]);
}

// The direction from the centre of the ring in this place of the memory to one of its corners. The first is there twice, for the seam of the texture.
fn outward(surface: Surface, slot: u32, corner: u32) -> vec3f {
    let angle = 6.2831855 * f32(corner % surface.sides) / f32(surface.sides);
    let up = cross(tangents[slot], acrosses[slot]);
    return acrosses[slot] * cos(angle) + up * sin(angle);
}

// Writes a corner of a cap, or its middle, on the ring in this place of the memory.
fn write_cap(surface: Surface, end: u32, slot: u32, corner: u32) {
    let first = surface.ring_count * (surface.sides + 1u) + end * (surface.sides + 2u);
    var place = centres[slot];
    if corner <= surface.sides {
        place += outward(surface, slot, corner) * surface.radius;
    }
    write_vertex(surface, first + corner, place, tangents[slot] * select(1.0, -1.0, end == 0u));
}

@compute @workgroup_size(WORKGROUP)
fn write_tube(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) thread: u32,
) {
    let number = number_of(group, groups);
    if number >= shares[0].x {
        return;
    }
    let surface = surfaces[shares[number + 1u].x];
    let corners = surface.sides + 1u;
    // Of the ring before; only the first thread's count.
    var tangent = vec3f(0.0, 1.0, 0.0);
    var across = vec3f(0.0);
    for (var first = 0u; first < surface.ring_count; first += WORKGROUP) {
        let count = min(surface.ring_count - first, WORKGROUP);
        if thread < count {
            let centre = centre_of(surface, first + thread);
            centres[thread] = centre;
            tangents[thread] = tangent_of(surface, first + thread, centre);
        }
        workgroupBarrier();
        if thread == 0u {
            for (var i = 0u; i < count; i++) {
                let next = select(tangent, tangents[i], any(tangents[i] != vec3f(0.0)));
                if first + i == 0u {
                    across = across_from(last_across(surface), next);
                } else {
                    across = across_from(transported(across, tangent, next), next);
                }
                tangent = next;
                tangents[i] = tangent;
                acrosses[i] = across;
            }
        }
        workgroupBarrier();
        for (var i = thread; i < count * corners; i += WORKGROUP) {
            let slot = i / corners;
            let normal = outward(surface, slot, i % corners);
            write_vertex(surface, first * corners + i, centres[slot] + normal * surface.radius, normal);
        }
        if first == 0u {
            for (var corner = thread; corner <= corners; corner += WORKGROUP) {
                write_cap(surface, 0u, 0u, corner);
            }
        }
        if first + count == surface.ring_count {
            for (var corner = thread; corner <= corners; corner += WORKGROUP) {
                write_cap(surface, 1u, count - 1u, corner);
            }
        }
        // The next rings take the places of these.
        workgroupBarrier();
    }
}
