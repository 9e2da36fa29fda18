// The force of the air: `air_force.rs` of the solver has the same formulas.

// A smaller part of the wind across a link is rounding, and has no direction.
const LEAST_ACROSS: f32 = 1e-5;

fn air_velocity(place: vec3f) -> vec3f {
    var velocity = step.wind;
    for (var i = 0u; i < step.wave_count; i++) {
        let wave = step.waves[i];
        velocity += wave.amplitude * cos(dot(wave.number, place) + wave.phase);
    }
    return velocity;
}

// Force on an element with this normal and area, in newtons. It brings a corner to the speed of the air within the step,
// never past it: `by_force` is the change of speed by one newton.
fn air_force(relative: vec3f, normal: vec3f, area: f32, by_force: f32, has_lift: bool) -> vec3f {
    let speed = dot(relative, normal);
    let strength = step.drag * area * speed * abs(speed);
    let most = abs(speed) / by_force;
    var force = normal * clamp(strength, -most, most);
    let size = length(relative);
    if has_lift && step.lift != 0.0 && size > 0.0 {
        let lift = (normal * (size * size) - relative * speed) * (step.lift * area * speed / size);
        let limit = size / by_force;
        force += lift * min(1.0, limit / max(length(lift), 1e-30));
    }
    return force;
}

// The displacement in a substep that the wind finds. A pin that has a target moves towards it.
fn moved_in_substep(body: Body, index: u32) -> vec3f {
    let moved = displacements[body.first_particle + index];
    let way = (moved.xyz - positions[body.first_particle + index].xyz) / f32(body.substeps);
    return select(moved.xyz * body.rescale, way, moved.w != 0.0);
}

// Acceleration of a particle by the air, in m/s^2. `index` counts from the body's first particle.
fn air_acceleration(body: Body, index: u32) -> vec3f {
    if body.has_squares != 0u {
        return air_on_squares(body, index);
    }
    return air_on_fan(body, index);
}

// By the sum over the squares around it, of which it has a quarter each.
fn air_on_squares(body: Body, index: u32) -> vec3f {
    let column = index % body.columns;
    let row = index / body.columns;
    var sum = vec3f(0.0);
    for (var side = 0u; side < 4u; side++) {
        // From the particle to the first corner of the square.
        let left = side % 2u;
        let up = side / 2u;
        if column < left || row < up || column - left + 1u >= body.columns || row - up + 1u >= body.rows {
            continue;
        }
        let first = index - left - up * body.columns;
        let a = positions[body.first_particle + first];
        let b = positions[body.first_particle + first + 1u];
        let c = positions[body.first_particle + first + body.columns];
        let d = positions[body.first_particle + first + body.columns + 1u];
        let double_area = cross(d.xyz - a.xyz, b.xyz - c.xyz);
        let size = length(double_area);
        if size > 0.0 {
            let moved = moved_in_substep(body, first) + moved_in_substep(body, first + 1u)
                + moved_in_substep(body, first + body.columns) + moved_in_substep(body, first + body.columns + 1u);
            let velocity = air_velocity(body.origin + 0.25 * (a.xyz + b.xyz + c.xyz + d.xyz));
            let relative = velocity - moved * (0.25 / body.substep);
            // Four squares meet at a particle and share the limit.
            let by_force = step.duration * max(0.25 * (a.w + b.w + c.w + d.w), 1e-30);
            sum += air_force(relative, double_area / size, 0.5 * size, by_force, true) * 0.25;
        }
    }
    return sum * positions[body.first_particle + index].w;
}

// By the sum over the faces and links around it.
fn air_on_fan(body: Body, index: u32) -> vec3f {
    let here = positions[body.first_particle + index];
    let own = moved_in_substep(body, index);
    let per_second = 1.0 / body.substep;
    var sum = vec3f(0.0);
    let fan = pairs[body.first_fan + index];
    for (var i = fan.x; i < fan.y; i++) {
        let corners = pairs[body.first_fan + i];
        let second = corners.x;
        let third = corners.y;
        let q = positions[body.first_particle + second];
        let q_moved = moved_in_substep(body, second);
        if third == NONE {
            let along = q.xyz - here.xyz;
            let velocity = air_velocity(body.origin + 0.5 * (here.xyz + q.xyz));
            let across = velocity - along * (dot(velocity, along) / max(dot(along, along), 1e-30));
            let speed = length(across);
            if speed > LEAST_ACROSS * length(velocity) {
                let relative = velocity - (own + q_moved) * (0.5 * per_second);
                let area = 2.0 * body.thickness * length(along);
                let by_force = step.duration * max(0.5 * (here.w + q.w), 1e-30);
                sum += air_force(relative, across / speed, area, by_force, false) * 0.5;
            }
            continue;
        }
        let r = positions[body.first_particle + third];
        let r_moved = moved_in_substep(body, third);
        let double_area = cross(q.xyz - here.xyz, r.xyz - here.xyz);
        let size = length(double_area);
        if size > 0.0 {
            let velocity = air_velocity(body.origin + (here.xyz + q.xyz + r.xyz) / 3.0);
            let relative = velocity - (own + q_moved + r_moved) * (per_second / 3.0);
            // Six faces of a grid meet at a particle and share the limit.
            let by_force = step.duration * max((here.w + q.w + r.w) / 3.0, 1e-30) * 2.0;
            sum += air_force(relative, double_area / size, 0.5 * size, by_force, true) / 3.0;
        }
    }
    return sum * here.w;
}
