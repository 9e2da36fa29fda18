// Bodies that fit the memory of a workgroup: the whole step of a body in one workgroup, thousands side by side. Each thread owns some
// particles, whose motion it keeps to itself; positions lie in shared memory, where sticks find both ends.
//
// `WORKGROUP` threads own `PER_THREAD` particles each.

const CAPACITY: u32 = WORKGROUP * PER_THREAD;

// The bodies of one dispatch.
struct SizeClass {
    first_body: u32,
    body_count: u32,
    unused: vec2u,
}

@group(1) @binding(0) var<uniform> size_class: SizeClass;
@group(1) @binding(1) var<storage, read_write> statuses: array<Status>;
@group(1) @binding(2) var<storage, read_write> reactions: array<atomic<u32>>;

var<workgroup> places: array<vec4f, CAPACITY>;
var<workgroup> drift_sum: array<atomic<i32>, 3>;

fn project_stick(i: u32, batch: Batch, is_square_root_free: bool) {
    if i >= batch.count {
        return;
    }
    let stick = pairs[batch.first + i];
    // Both ends fit into one word.
    let a = stick.x & 0xffffu;
    let b = stick.x >> 16u;
    let p = places[a];
    let q = places[b];
    let pull = stick_pull(p, q, bitcast<f32>(stick.y), batch.stiffness, batch.side, is_square_root_free);
    places[a] = vec4f(p.xyz + pull * p.w, p.w);
    places[b] = vec4f(q.xyz - pull * q.w, q.w);
}

// Each particle is an end of one stick at most: there are no more sticks than half of the particles.
fn project_sticks(batch: Batch, thread: u32, is_square_root_free: bool) {
    project_stick(thread, batch, is_square_root_free);
    if PER_THREAD > 2u {
        project_stick(thread + WORKGROUP, batch, is_square_root_free);
    }
}

fn position_of(body: Body, index: u32) -> vec4f {
    return places[index];
}

@compute @workgroup_size(WORKGROUP)
fn step_body(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) thread: u32,
) {
    let order = number_of(group, groups);
    if order >= size_class.body_count {
        return;
    }
    let number = size_class.first_body + order;
    let body = bodies[number];
    let is_square_root_free = body.is_square_root_free != 0u;
    var flights: array<Flight, PER_THREAD>;
    var accelerations: array<vec3f, PER_THREAD>;

    clear_near(thread);
    workgroupBarrier();
    for (var k = 0u; k < PER_THREAD; k++) {
        let index = thread + k * WORKGROUP;
        if index < body.particle_count {
            let place = positions[body.first_particle + index];
            let moved = displacements[body.first_particle + index];
            places[index] = place;
            flights[k].displacement = moved.xyz * body.rescale;
            accelerations[k] = step.gravity;
            if place.w == 0.0 {
                // Pins go to their targets in equal parts.
                flights[k].displacement = select(vec3f(0.0), (moved.xyz - place.xyz) / f32(body.substeps), moved.w != 0.0);
            } else if step.is_windy != 0u {
                accelerations[k] += air_acceleration(body, index);
            }
            include(place.xyz, reach(flights[k].displacement, body), thread);
        }
    }
    workgroupBarrier();
    merge_lanes(thread);
    workgroupBarrier();
    find_near(thread, body);
    workgroupBarrier();

    for (var substep = 0u; substep < body.substeps; substep++) {
        for (var k = 0u; k < PER_THREAD; k++) {
            let index = thread + k * WORKGROUP;
            if index < body.particle_count {
                let place = places[index];
                if place.w > 0.0 {
                    flights[k].displacement = flights[k].displacement * body.decay + accelerations[k] * body.gain;
                }
                flights[k].integrated = place.xyz + flights[k].displacement;
                flights[k].depth = 0.0;
                flights[k].left = -1.0;
                flights[k].obstacle = NONE;
                places[index] = vec4f(flights[k].integrated, place.w);
            }
        }
        for (var iteration = 0u; iteration < body.iterations; iteration++) {
            project_contacts(thread, body, substep, &flights);
            workgroupBarrier();
            for (var i = 0u; i < body.batch_count; i++) {
                // Odd iterations run in reverse, so that an even number makes symmetric pairs.
                let batch = select(i, body.batch_count - 1u - i, iteration % 2u == 1u);
                project_sticks(batches[body.first_batch + batch], thread, is_square_root_free);
                workgroupBarrier();
            }
            if body.tethers_per_particle > 0u {
                for (var k = 0u; k < PER_THREAD; k++) {
                    let index = thread + k * WORKGROUP;
                    if index < body.particle_count {
                        let place = places[index];
                        if place.w > 0.0 {
                            places[index] = vec4f(held_by_tethers(place.xyz, index, body), place.w);
                        }
                    }
                }
                // Else a pin could go one substep further while others are still held by it.
                workgroupBarrier();
            }
        }
        project_contacts(thread, body, substep, &flights);
        let drift = drift_of(thread, body, &flights);
        // Displacements follow positions, then friction takes its part.
        for (var k = 0u; k < PER_THREAD; k++) {
            let index = thread + k * WORKGROUP;
            if index < body.particle_count {
                let place = places[index];
                if place.w > 0.0 {
                    flights[k].displacement += place.xyz - flights[k].integrated - drift;
                    if flights[k].depth > 0.0 {
                        let taken = slip_taken(place.xyz, place.w, body, substep, flights[k]);
                        flights[k].displacement -= taken;
                        places[index] = vec4f(place.xyz - taken, place.w);
                    }
                }
            }
        }
    }

    for (var k = 0u; k < PER_THREAD; k++) {
        let index = thread + k * WORKGROUP;
        if index < body.particle_count && !(is_finite(places[index].xyz) && is_finite(flights[k].displacement)) {
            atomicOr(&is_broken, 1u);
        }
    }
    workgroupBarrier();
    // A body with a particle that would not be finite rests where it was.
    let stays = atomicLoad(&is_broken) != 0u;
    workgroupBarrier();
    clear_near(thread);
    workgroupBarrier();
    for (var k = 0u; k < PER_THREAD; k++) {
        let index = thread + k * WORKGROUP;
        if index < body.particle_count {
            var place = places[index];
            var displacement = flights[k].displacement;
            if stays {
                place = positions[body.first_particle + index];
                displacement = vec3f(0.0);
            } else {
                positions[body.first_particle + index] = place;
            }
            displacements[body.first_particle + index] = vec4f(displacement, 0.0);
            include(place.xyz, 0.0, thread);
            atomicMax(&fastest, bitcast<u32>(dot(displacement, displacement)));
        }
    }
    workgroupBarrier();
    merge_lanes(thread);
    workgroupBarrier();
    if thread == 0u {
        atomicStore(&statuses[number].is_broken, u32(stays));
    }
    if thread < 3u {
        atomicStore(&statuses[number].low[thread], atomicLoad(&low[thread * LANES]));
        atomicStore(&statuses[number].high[thread], atomicLoad(&high[thread * LANES]));
        atomicStore(&statuses[number].fastest, atomicLoad(&fastest));
    }
}

// Metres by which rounding has moved the centre of mass of a free body in this substep.
fn drift_of(thread: u32, body: Body, flights: ptr<function, array<Flight, PER_THREAD>>) -> vec3f {
    if body.inverse_mass == 0.0 {
        return vec3f(0.0);
    }
    if thread < 3u {
        atomicStore(&drift_sum[thread], 0);
    }
    workgroupBarrier();
    for (var k = 0u; k < PER_THREAD; k++) {
        let index = thread + k * WORKGROUP;
        if index < body.particle_count {
            let part = drift_by(places[index].xyz - (*flights)[k].integrated, places[index].w, body);
            for (var axis = 0u; axis < 3u; axis++) {
                atomicAdd(&drift_sum[axis], part[axis]);
            }
        }
    }
    workgroupBarrier();
    let sum = vec3i(atomicLoad(&drift_sum[0]), atomicLoad(&drift_sum[1]), atomicLoad(&drift_sum[2]));
    return vec3f(sum) / DRIFT_UNITS;
}

fn project_contacts(thread: u32, body: Body, substep: u32, flights: ptr<function, array<Flight, PER_THREAD>>) {
    if step.obstacle_count == 0u {
        return;
    }
    for (var k = 0u; k < PER_THREAD; k++) {
        let index = thread + k * WORKGROUP;
        if index < body.particle_count {
            let place = places[index];
            if place.w > 0.0 {
                var flight = (*flights)[k];
                places[index] = vec4f(pushed_out_of_near(place.xyz, place.w, body, substep, &flight), place.w);
                (*flights)[k] = flight;
            }
        }
    }
}
