// The data of one dispatch of a large body.

struct Dispatch {
    body: u32,
    // Index of a batch of sticks.
    batch: u32,
    // The substep that begins or goes on.
    substep: u32,
    iteration: u32,
    // 1 if the substep before ends in this dispatch, and if one begins.
    ends: u32,
    begins: u32,
    unused: vec2u,
}

@group(1) @binding(0) var<uniform> dispatch: Dispatch;
