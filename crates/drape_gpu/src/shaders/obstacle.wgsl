// Shapes of obstacles, and contacts with them: `surface_lanes.rs`, `particle_obstacle.rs` and `friction.rs` of the solver have
// the same rules.

const HALF_SPACE: u32 = 0u;
const SPHERE: u32 = 1u;
const CAPSULE: u32 = 2u;
const TAPERED_CAPSULE: u32 = 3u;
const CUBOID: u32 = 4u;
const CONTAINER: u32 = 5u;
const FIELD: u32 = 6u;

// Overlaps of less than so many metres at the start of a substep count as none.
const LEAST_OVERLAP: f32 = {LEAST_OVERLAP};
// Metres around boxes within which contacts are looked for.
const CONTACT_MARGIN: f32 = {CONTACT_MARGIN};
// Speed in m/s at which an overlap that no motion made is taken out at least.
const PUSH_OUT_SPEED: f32 = {PUSH_OUT_SPEED};
// Seconds.
const REFERENCE_STEP: f32 = {REFERENCE_STEP};

fn rotated(rotation: vec4f, v: vec3f) -> vec3f {
    let t = 2.0 * cross(rotation.xyz, v);
    return v + rotation.w * t + cross(rotation.xyz, t);
}

fn to_local(place: Place, point: vec3f) -> vec3f {
    return rotated(vec4f(-place.rotation.xyz, place.rotation.w), point - place.translation);
}

fn to_world(place: Place, point: vec3f) -> vec3f {
    return rotated(place.rotation, point) + place.translation;
}

// The place of an obstacle at a fraction of its way, relative to `origin`.
fn place_at(obstacle: Obstacle, fraction: f32, origin: vec3f) -> Place {
    if obstacle.is_moving == 0u {
        return Place(obstacle.end - origin, obstacle.end_rotation);
    }
    let rotation = mix(obstacle.start_rotation, obstacle.end_rotation, fraction);
    return Place(mix(obstacle.start, obstacle.end, fraction) - origin, normalize(rotation));
}

// Unit normal and distance of what is around a core, at a `point` seen from its nearest point in the core.
fn around_core(point: vec3f, radius: f32) -> vec4f {
    let distance = length(point);
    let normal = select(vec3f(0.0, 1.0, 0.0), point / distance, distance > 0.0);
    return vec4f(normal, distance - radius);
}

fn cuboid(point: vec3f, half_extents: vec3f) -> vec4f {
    let side = select(vec3f(1.0), vec3f(-1.0), point < vec3f(0.0));
    let beyond = abs(point) - half_extents;
    let outside = max(beyond, vec3f(0.0));
    let distance = length(outside);
    if distance > 0.0 {
        return vec4f(outside * side / distance, distance);
    }
    if beyond.x >= beyond.y && beyond.x >= beyond.z {
        return vec4f(side.x, 0.0, 0.0, beyond.x);
    }
    if beyond.y >= beyond.z {
        return vec4f(0.0, side.y, 0.0, beyond.y);
    }
    return vec4f(0.0, 0.0, side.z, beyond.z);
}

// The wall of a box that is nearest from within.
fn container(point: vec3f, half_extents: vec3f) -> vec4f {
    let side = select(vec3f(1.0), vec3f(-1.0), point < vec3f(0.0));
    let room = half_extents - abs(point);
    if room.x <= room.y && room.x <= room.z {
        return vec4f(-side.x, 0.0, 0.0, room.x);
    }
    if room.y <= room.z {
        return vec4f(0.0, -side.y, 0.0, room.y);
    }
    return vec4f(0.0, 0.0, -side.z, room.z);
}

// A distance of an obstacle's field.
fn distance_at(obstacle: Obstacle, corner: vec3u) -> f32 {
    let index = (corner.z * obstacle.corners.y + corner.y) * obstacle.corners.x + corner.x;
    let pair = pairs[obstacle.first_pair + index / 2u];
    return bitcast<f32>(select(pair.x, pair.y, index % 2u == 1u));
}

// Interpolates between the corners of a cell.
fn in_field(obstacle: Obstacle, point: vec3f) -> vec4f {
    var unclamped = (point - obstacle.size.xyz) / obstacle.cell;
    if obstacle.size.w != 0.0 {
        unclamped.y = max(unclamped.y, 0.0);
    }
    let place = clamp(unclamped, vec3f(0.0), vec3f(obstacle.corners - 1u));
    let first = min(vec3u(place), obstacle.corners - 2u);
    let part = place - vec3f(first);
    // The four edges along x, by y and z.
    let starts = vec4f(
        distance_at(obstacle, first),
        distance_at(obstacle, first + vec3u(0u, 1u, 0u)),
        distance_at(obstacle, first + vec3u(0u, 0u, 1u)),
        distance_at(obstacle, first + vec3u(0u, 1u, 1u)),
    );
    let ends = vec4f(
        distance_at(obstacle, first + vec3u(1u, 0u, 0u)),
        distance_at(obstacle, first + vec3u(1u, 1u, 0u)),
        distance_at(obstacle, first + vec3u(1u, 0u, 1u)),
        distance_at(obstacle, first + vec3u(1u, 1u, 1u)),
    );
    let on_edges = mix(starts, ends, part.x);
    let on_faces = mix(on_edges.xz, on_edges.yw, part.y);
    let slopes_x = mix((ends - starts).xz, (ends - starts).yw, part.y);
    let slopes_y = on_edges.yw - on_edges.xz;
    let gradient = vec3f(
        mix(slopes_x.x, slopes_x.y, part.z),
        mix(slopes_y.x, slopes_y.y, part.z),
        on_faces.y - on_faces.x,
    ) / obstacle.cell;
    let slope = length(gradient);
    let normal = select(vec3f(0.0, 1.0, 0.0), gradient / slope, slope > 0.0);
    let distance = mix(on_faces.x, on_faces.y, part.z);
    let beyond = (unclamped - place) * obstacle.cell;
    if all(beyond == vec3f(0.0)) {
        return vec4f(normal, distance);
    }
    // Outside the lattice: to the point of the surface that is nearest to the lattice's border.
    let way = beyond + normal * distance;
    let signed_length = select(length(way), -length(way), distance < 0.0);
    return vec4f(way / signed_length, signed_length);
}

// Outward unit normal and distance, negative inside, of the surface nearest to a point in the obstacle's coordinates.
fn surface_at(obstacle: Obstacle, point: vec3f) -> vec4f {
    let size = obstacle.size;
    if HAS_EXTRAS && obstacle.shape == FIELD {
        return in_field(obstacle, point);
    }
    switch obstacle.shape {
        case SPHERE: {
            return around_core(point, size.x);
        }
        case CAPSULE: {
            let height = clamp(point.y, -size.x, size.x);
            return around_core(vec3f(point.x, point.y - height, point.z), size.y);
        }
        case TAPERED_CAPSULE: {
            // Lowest centre, highest centre, lowest radius, growth of the radius by the height.
            let slope = -size.w / sqrt(max(1.0 - size.w * size.w, 1e-12));
            let height = clamp(point.y - length(point.xz) * slope, size.x, size.y);
            return around_core(vec3f(point.x, point.y - height, point.z), size.z + (height - size.x) * size.w);
        }
        case CUBOID: {
            return cuboid(point, size.xyz);
        }
        case CONTAINER: {
            return container(point, size.xyz);
        }
        default: {
            return vec4f(size.xyz, dot(size.xyz, point));
        }
    }
}

// A particle in one substep.
struct Flight {
    displacement: vec3f,
    // Metres of an overlap that no motion made, which may be left at the end of the substep; negative until it is known.
    left: f32,
    // Position after free flight, from which projections are measured.
    integrated: vec3f,
    // Depth in the obstacle that presses most, as far as motion made it, summed over the projections of the substep.
    depth: f32,
    normal: vec3f,
    // `NONE` until one presses.
    obstacle: u32,
}

// Metres of an overlap that may be left at the end of a substep.
fn left_of(initial: f32, body: Body, substep: u32) -> f32 {
    let rest = f32(max(body.substeps - substep, 1u));
    let is_short = body.substep * f32(body.substeps) < 0.999 * REFERENCE_STEP;
    let spread = select(rest, max(rest, REFERENCE_STEP / body.substep), is_short);
    return max(min(initial - initial / spread, initial - PUSH_OUT_SPEED * body.substep), 0.0);
}

// False if the particle is beside the box of an obstacle, as most are: the box is read much faster than the rest of it.
fn is_at(position: vec3f, index: u32, body: Body) -> bool {
    let margin = body.thickness + CONTACT_MARGIN;
    let place = position + body.origin;
    return all(place + margin >= obstacles[index].low) && all(place - margin <= obstacles[index].high);
}

// Moves a particle out of an obstacle, along the normal to the nearest point of its surface. Returns the position.
fn pushed_out(
    position: vec3f,
    inverse_mass: f32,
    index: u32,
    body: Body,
    substep: u32,
    flight: ptr<function, Flight>,
) -> vec3f {
    let obstacle = obstacles[index];
    let count = f32(body.substeps);
    let now = place_at(obstacle, f32(substep + 1u) / count, body.origin);
    let local = to_local(now, position);
    let surface = surface_at(obstacle, local);
    let depth = body.thickness - surface.w;
    if !(depth > 0.0) {
        return position;
    }
    let normal = rotated(now.rotation, surface.xyz);
    let travel = (*flight).displacement + (position - (*flight).integrated);
    var outward = travel;
    var before = now;
    if obstacle.is_moving != 0u {
        before = place_at(obstacle, f32(substep) / count, body.origin);
        outward -= position - to_world(before, local);
    }
    var with_velocity = depth;
    var out = depth;
    // Unless the tangent plane rules out an overlap at the start of the substep, the shape is queried there.
    if depth + dot(outward, normal) > LEAST_OVERLAP {
        let overlap = body.thickness - surface_at(obstacle, to_local(before, position - travel)).w;
        let initial = clamp(overlap, 0.0, depth);
        if (*flight).left < 0.0 {
            (*flight).left = left_of(initial, body, substep);
        }
        with_velocity = depth - initial;
        out = with_velocity + max(initial - (*flight).left, 0.0);
    }
    (*flight).displacement += normal * with_velocity;
    note_push(index, normal * with_velocity, position, inverse_mass, body);
    (*flight).integrated += normal * out;
    // Friction is that of the obstacle that presses most.
    let is_same = index == (*flight).obstacle;
    if is_same || with_velocity > (*flight).depth {
        (*flight).depth = select(with_velocity, (*flight).depth + with_velocity, is_same);
        (*flight).normal = normal;
        (*flight).obstacle = index;
    }
    return position + normal * out;
}

fn combined(rule: u32, a: f32, b: f32) -> f32 {
    switch rule {
        case 1u: { return sqrt(a * b); }
        case 2u: { return min(a, b); }
        case 3u: { return a * b; }
        case 4u: { return max(a, b); }
        case 5u: { return min(a + b, 1.0); }
        default: { return 0.5 * (a + b); }
    }
}

// The displacement that friction takes from a particle, along the surface of the obstacle that presses it most: at most the
// coefficient times the depth, and never more than the slip (Jakobsen 2001).
fn slip_taken(position: vec3f, inverse_mass: f32, body: Body, substep: u32, flight: Flight) -> vec3f {
    let obstacle = obstacles[flight.obstacle];
    var slip = flight.displacement;
    if obstacle.is_moving != 0u {
        let count = f32(body.substeps);
        let now = place_at(obstacle, f32(substep + 1u) / count, body.origin);
        let before = place_at(obstacle, f32(substep) / count, body.origin);
        slip -= position - to_world(before, to_local(now, position));
    }
    let tangential = slip - flight.normal * dot(slip, flight.normal);
    let way = length(tangential);
    let kinetic = combined(obstacle.combine_rule, body.friction, obstacle.friction);
    let sticking = combined(obstacle.combine_rule, body.static_friction, obstacle.static_friction);
    let taken = tangential * select(1.0, kinetic * flight.depth / way, way > sticking * flight.depth);
    note_push(flight.obstacle, -taken, position, inverse_mass, body);
    return taken;
}

// True if a body in these layers collides with an obstacle.
fn interacts(body: Body, obstacle: Obstacle) -> bool {
    return (body.memberships & obstacle.filters) != 0u && (obstacle.memberships & body.filters) != 0u;
}
