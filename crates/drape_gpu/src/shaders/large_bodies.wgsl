// Bodies too large for the memory of a workgroup: each stage of a substep is a dispatch of its own over all particles, or over all sticks
// of a batch.

// In the first half, for each particle its position after free flight, and what may be left of an overlap. In the second half the normal of the
// contact that presses most, and its summed depth, which have no meaning as long as no obstacle presses.
@group(1) @binding(1) var<storage, read_write> flights: array<vec4f>;
// Acceleration, and the obstacle that presses most or -1. Of a pin, its way in a substep.
@group(1) @binding(2) var<storage, read_write> accelerations: array<vec4f>;
@group(1) @binding(3) var<storage, read_write> statuses: array<Status>;
@group(1) @binding(4) var<storage, read_write> reactions: array<atomic<u32>>;

// The index of a thread's particle or stick in the body or batch.
fn index_of(invocation: Invocation) -> u32 {
    return number_of(invocation.group, invocation.groups) * WORKGROUP + invocation.thread;
}

// Before the first substep: forces, and the ways of pins.
@compute @workgroup_size(WORKGROUP)
fn begin(invocation: Invocation) {
    let body = bodies[dispatch.body];
    let index = index_of(invocation);
    if index < 3u {
        atomicStore(&statuses[dispatch.body].drift[index], 0);
        atomicStore(&statuses[dispatch.body].drift[3u + index], 0);
        atomicStore(&statuses[dispatch.body].low[index], 0xffffffffu);
        atomicStore(&statuses[dispatch.body].high[index], 0u);
        atomicStore(&statuses[dispatch.body].fastest, 0u);
        atomicStore(&statuses[dispatch.body].is_broken, 0u);
    }
    if index >= body.particle_count {
        return;
    }
    let particle = body.first_particle + index;
    let place = positions[particle];
    var acceleration = vec3f(0.0);
    if place.w == 0.0 {
        let moved = displacements[particle];
        // The way of a pin in a substep, in place of its acceleration.
        acceleration = select(vec3f(0.0), (moved.xyz - place.xyz) / f32(body.substeps), moved.w != 0.0);
    } else {
        acceleration = step.gravity;
        if step.is_windy != 0u {
            acceleration += air_acceleration(body, index);
        }
    }
    accelerations[particle] = vec4f(acceleration, -1.0);
}

var<workgroup> drift_sum: array<atomic<i32>, 3>;

// Sums up the drift of a free body, after the last projection of sticks in a substep.
@compute @workgroup_size(WORKGROUP)
fn note_drift(invocation: Invocation) {
    let thread = invocation.thread;
    let body = bodies[dispatch.body];
    let index = index_of(invocation);
    if thread < 3u {
        atomicStore(&drift_sum[thread], 0);
    }
    workgroupBarrier();
    if index < body.particle_count {
        let place = positions[body.first_particle + index];
        let part = drift_by(place.xyz - flights[body.first_particle + index].xyz, place.w, body);
        for (var axis = 0u; axis < 3u; axis++) {
            atomicAdd(&drift_sum[axis], part[axis]);
        }
    }
    workgroupBarrier();
    if thread < 3u {
        let even = 3u * (dispatch.substep % 2u);
        atomicAdd(&statuses[dispatch.body].drift[even + thread], atomicLoad(&drift_sum[thread]));
        if index < 3u {
            // That of the substep before has been used.
            atomicStore(&statuses[dispatch.body].drift[3u - even + thread], 0);
        }
    }
}

// Finds the obstacles near the workgroup's particles, one a thread.
fn search(position: vec3f, way: f32, thread: u32, body: Body) {
    clear_near(thread);
    workgroupBarrier();
    include(position, way, thread);
    workgroupBarrier();
    merge_lanes(thread);
    workgroupBarrier();
    find_near(thread, body);
    workgroupBarrier();
}

// `pressing` is the obstacle that presses most or -1.
fn flight_of(particle: u32, displacement: vec3f, pressing: f32) -> Flight {
    let flown = flights[particle];
    if pressing < 0.0 {
        return Flight(displacement, flown.w, flown.xyz, 0.0, vec3f(0.0), NONE);
    }
    let contact = flights[arrayLength(&flights) / 2u + particle];
    return Flight(displacement, flown.w, flown.xyz, contact.w, contact.xyz, u32(pressing));
}

// `pressing` is what was kept before.
fn keep(particle: u32, flight: Flight, pressing: f32) {
    flights[particle] = vec4f(flight.integrated, flight.left);
    if flight.obstacle != NONE {
        flights[arrayLength(&flights) / 2u + particle] = vec4f(flight.normal, flight.depth);
        accelerations[particle].w = f32(flight.obstacle);
    } else if pressing >= 0.0 {
        accelerations[particle].w = -1.0;
    }
}

// Ends a substep (contacts, displacements, friction), begins the next one (free flight, contacts), or does both.
@compute @workgroup_size(WORKGROUP)
fn advance(invocation: Invocation) {
    let thread = invocation.thread;
    let body = bodies[dispatch.body];
    let index = index_of(invocation);
    let particle = body.first_particle + min(index, body.particle_count - 1u);
    let has_obstacles = step.obstacle_count > 0u;
    let place = positions[particle];
    let is_free = place.w > 0.0;
    let kept = accelerations[particle];
    let acceleration = kept.xyz;
    var position = place.xyz;
    var flight: Flight;
    let rescale = select(1.0, body.rescale, dispatch.substep == 0u);
    flight.displacement = select(acceleration, displacements[particle].xyz * rescale, is_free);

    if has_obstacles {
        // The way of a free substep, and a margin for the pull of sticks.
        search(position, length(flight.displacement) + body.thickness + CONTACT_MARGIN, thread, body);
    }
    let is_there = index < body.particle_count;
    if is_there && dispatch.ends != 0u && is_free {
        if has_obstacles {
            flight = flight_of(particle, flight.displacement, kept.w);
            if is_at_any(position, body) {
                position = pushed_out_of_near(position, place.w, body, dispatch.substep - 1u, &flight);
            }
        } else {
            flight.integrated = flights[particle].xyz;
        }
        let even = 3u * ((dispatch.substep - 1u) % 2u);
        let drift = vec3i(
            atomicLoad(&statuses[dispatch.body].drift[even]),
            atomicLoad(&statuses[dispatch.body].drift[even + 1u]),
            atomicLoad(&statuses[dispatch.body].drift[even + 2u]),
        );
        flight.displacement += position - flight.integrated - vec3f(drift) / DRIFT_UNITS;
        if flight.depth > 0.0 {
            let taken = slip_taken(position, place.w, body, dispatch.substep - 1u, flight);
            flight.displacement -= taken;
            position -= taken;
        }
        if !(is_finite(position) && is_finite(flight.displacement)) {
            // It rests where free flight had taken it, so that the fault does not spread.
            position = flights[particle].xyz;
            flight.displacement = vec3f(0.0);
            atomicStore(&statuses[dispatch.body].is_broken, 1u);
        }
    }
    if is_there && dispatch.begins != 0u {
        if is_free {
            flight.displacement = flight.displacement * body.decay + acceleration * body.gain;
        }
        if is_finite(position + flight.displacement) {
            position += flight.displacement;
        } else {
            flight.displacement = vec3f(0.0);
            atomicStore(&statuses[dispatch.body].is_broken, 1u);
        }
        flight.integrated = position;
        flight.left = -1.0;
        flight.depth = 0.0;
        flight.normal = vec3f(0.0);
        flight.obstacle = NONE;
        if has_obstacles && is_free && is_at_any(position, body) {
            position = pushed_out_of_near(position, place.w, body, dispatch.substep, &flight);
        }
        keep(particle, flight, kept.w);
    }
    if is_there {
        positions[particle] = vec4f(position, place.w);
        displacements[particle] = vec4f(flight.displacement, 0.0);
    }
    if dispatch.begins == 0u {
        workgroupBarrier();
        clear_near(thread);
        workgroupBarrier();
        if is_there {
            include(position, 0.0, thread);
            atomicMax(&fastest, bitcast<u32>(dot(flight.displacement, flight.displacement)));
        }
        workgroupBarrier();
        merge_lanes(thread);
        workgroupBarrier();
        if thread < 3u {
            atomicMin(&statuses[dispatch.body].low[thread], atomicLoad(&low[thread * LANES]));
            atomicMax(&statuses[dispatch.body].high[thread], atomicLoad(&high[thread * LANES]));
            atomicMax(&statuses[dispatch.body].fastest, atomicLoad(&fastest));
        }
    }
}

// Contacts between two iterations.
@compute @workgroup_size(WORKGROUP)
fn project_contacts(invocation: Invocation) {
    let thread = invocation.thread;
    let body = bodies[dispatch.body];
    let index = index_of(invocation);
    let particle = body.first_particle + min(index, body.particle_count - 1u);
    let place = positions[particle];
    search(place.xyz, body.thickness, thread, body);
    if index >= body.particle_count || place.w == 0.0 || !is_at_any(place.xyz, body) {
        return;
    }
    let pressing = accelerations[particle].w;
    var flight = flight_of(particle, displacements[particle].xyz, pressing);
    let position = pushed_out_of_near(place.xyz, place.w, body, dispatch.substep, &flight);
    keep(particle, flight, pressing);
    positions[particle] = vec4f(position, place.w);
    displacements[particle] = vec4f(flight.displacement, 0.0);
}

@compute @workgroup_size(WORKGROUP)
fn project_sticks(invocation: Invocation) {
    let body = bodies[dispatch.body];
    let batch = batches[dispatch.batch];
    let index = index_of(invocation);
    if index >= batch.count {
        return;
    }
    // The ends, and the rest length.
    let ends = pairs[batch.first + 2u * index];
    let rest_length = bitcast<f32>(pairs[batch.first + 2u * index + 1u].x);
    let a = body.first_particle + ends.x;
    let b = body.first_particle + ends.y;
    let p = positions[a];
    let q = positions[b];
    let pull = stick_pull(p, q, rest_length, batch.stiffness, batch.side, body.is_square_root_free != 0u);
    positions[a] = vec4f(p.xyz + pull * p.w, p.w);
    positions[b] = vec4f(q.xyz - pull * q.w, q.w);
}

@compute @workgroup_size(WORKGROUP)
fn project_tethers(invocation: Invocation) {
    let body = bodies[dispatch.body];
    let index = index_of(invocation);
    if index >= body.particle_count {
        return;
    }
    let place = positions[body.first_particle + index];
    if place.w > 0.0 {
        positions[body.first_particle + index] = vec4f(held_by_tethers(place.xyz, index, body), place.w);
    }
}
