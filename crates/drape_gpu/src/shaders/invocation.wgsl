// The inputs of all kernels that are numbered along two axes.
struct Invocation {
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) thread: u32,
}

// The number of a workgroup. Kernels with a barrier after a return take these two apart: browsers see that they are the same for all threads only
// outside of a structure with the thread.
fn number_of(group: vec3u, groups: vec3u) -> u32 {
    return group.y * groups.x + group.x;
}
