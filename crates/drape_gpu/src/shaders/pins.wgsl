// Hands the targets of pins to their particles.

struct PinTarget {
    // In the coordinates of the body.
    place: vec3f,
    particle: u32,
}

// The first one has the number of the others in `particle`.
@group(0) @binding(0) var<storage, read> pin_targets: array<PinTarget>;
@group(0) @binding(1) var<storage, read_write> displacements: array<vec4f>;

@compute @workgroup_size(WORKGROUP)
fn set_targets(invocation: Invocation) {
    let index = number_of(invocation.group, invocation.groups) * WORKGROUP + invocation.thread;
    if index < pin_targets[0].particle {
        let pin = pin_targets[index + 1u];
        displacements[pin.particle] = vec4f(pin.place, 1.0);
    }
}
