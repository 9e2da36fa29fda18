//! Every tolerance of the solver, with its unit and the reason for its value.

/// Time that stiffness values refer to, in seconds: a stick of stiffness `s` loses the fraction `s` of
/// its strain in one reference step. One frame of a 60 Hz game, the step that artists tune by.
pub const REFERENCE_STEP: f32 = 1.0 / 60.0;

/// Substep assumed until a body is first stepped, in seconds. Any value does: displacements are rescaled
/// when the real substep is known. A power of two keeps that rescaling free of rounding.
pub const INITIAL_SUBSTEP: f32 = 1.0 / 1024.0;

/// Skin around the particles of a body with self-contact, as a part of the distance that they keep. A wider one has to be
/// left less often, and holds more pairs.
pub const SKIN: f32 = 0.5;

/// Beyond the distance that self-contact keeps, pairs within this part of it more are looked at in all projections of a
/// substep: sticks and contacts may yet push them together.
pub const CONTACT_SLACK: f32 = 0.25;

/// How far triangles may move, in distances that self-contact keeps, before those near each other are picked anew within
/// a step.
pub const SLACK_OF_SUBSTEPS: f32 = 0.25;

/// What the length of edges adds to the skin where contact is by triangles.
pub const SKIN_OF_EDGE: f32 = 0.25;

/// Elements in a leaf of the tree of a body's surface: fewer make more boxes, more make more pairs in each.
pub const ELEMENTS_OF_LEAF: usize = 4;

/// A patch of cloth lies flat if the normals of all its faces lean to one side by at least this cosine.
pub const LEAST_FLAT_COSINE: f32 = 0.2;

/// How often contacts of cloth with cloth and with obstacles are projected in turn. Each round halves the weight that two
/// layers on an obstacle leave for the next substep: with one, the upper never comes to rest.
pub const ROUNDS_OF_LAYERS: u32 = 4;

/// Speed at which layers that cross are led apart, in metres per second.
pub const UNTANGLING_SPEED: f32 = 0.5;

/// Particles of a body that are nearer to each other at rest than this, in distances that self-contact keeps, do not
/// touch: sticks hold them. More than 1, so that sticks a little compressed are not at work against contacts.
pub const NEIGHBOURS_AT_REST: f32 = 1.1;

/// Slack of the contact search, in metres: a particle this far beyond its reach is still looked at, as
/// sticks and balls can push a particle faster within a step than it moved before.
pub const CONTACT_MARGIN: f32 = 0.05;

/// A ball may cross at most this fraction of its radius in one substep; faster balls get more substeps.
/// At one half, a ball's centre cannot pass a face between two projections.
pub const BALL_TRAVEL_PER_SUBSTEP: f32 = 0.5;

/// Upper bound on substeps per step that a heavy ball near a light cloth can ask for: see `contact_ball_cloth`.
pub const MAX_HIT_SUBSTEPS: f32 = 256.0;

/// The part of the substeps of a hit that a ball near a cloth keeps from step to step while it needs fewer.
pub const HIT_SUBSTEPS_KEPT: f32 = 0.9;

/// A particle that is nearer than this to the end of its limit on motion is at it, in metres: what single precision leaves.
pub const AT_LIMIT: f32 = 1e-5;

/// How much deeper than its surface a particle may be in an obstacle before its limit on motion counts as the reason, in metres.
pub const LIMIT_CONFLICT_DEPTH: f32 = 1e-3;

/// Cells from which on a sweep runs down the strips of a grid: smaller bodies stay in the nearest cache anyway.
pub const LEAST_SWEPT_CELLS: usize = 128;

/// Cells that a stage takes at once in a sweep: enough to be worth the call, and few enough that those of all stages
/// stay in the nearest cache.
pub const CELLS_AT_ONCE: usize = 64;

/// What a cell's particles, masses and tethers take up in a sweep, in bytes.
pub const BYTES_OF_CELL: usize = 800;

/// What the strips between the first stage of a sweep and its last may take up, in bytes: the second cache of a core.
pub const SWEPT_BYTES: usize = 3 << 19;

/// Cells for each thread from which on threads share a body.
pub const LEAST_SHARED_CELLS: usize = 400;

/// Where threads share a body, strips for each thread and strip of lag: the wedges between them are done by one alone.
pub const LEAST_STRIPS_PER_LAG: usize = 8;

/// What the contacts of a cell that may touch an obstacle cost, compared with all else that is done to a cell.
pub const WORK_OF_CONTACTS: f32 = 0.5;

/// Overlaps of particles and obstacles below this, in metres, are rounding.
pub const LEAST_OVERLAP: f32 = 1e-6;

/// Particles from which on an irregular body is renumbered: smaller ones stay in the nearest cache anyway.
pub const LEAST_RENUMBERED: usize = 256;

/// Tethers pull a particle home at this speed at most, in metres per second. What hangs from a pin is pulled by
/// millimetres; what something has dragged a metre away is not to come back as a bullet.
pub const TETHER_SPEED: f32 = 50.0;

/// Tethers leave alone what is within this many radii of a ball.
pub const TETHERLESS_REACH: f32 = 1.5;

/// What a [line solve](crate::StructuralSolve::Lines) adds to the diagonal of its matrix, as a part of it. A straight
/// chain between two pins has one stick too many for its particles: without this its matrix has no inverse. Costs a
/// loaded line a hundredth of a per cent of stretch.
pub const CHAIN_REGULARISER: f32 = 1e-4;

/// How far the ends of a stick may move against each other in a line solve, in rest lengths. The solve takes sticks as
/// straight; one that turns by more than this ends longer than it was.
pub const CHAIN_STEP: f32 = 0.5;

/// Upper bound on substeps per step that a fast ball can ask for: bounds the work of a step.
pub const MAX_SUBSTEPS: u32 = 256;

/// Upper bound on relaxation iterations per substep: bounds the work of a step.
pub const MAX_ITERATIONS: u32 = 1024;

/// Tethers kept for each particle: the nearest pins. More buy nothing that can be seen.
pub const MAX_TETHERS: usize = 4;

/// A body whose centre is farther than this from its local origin is given a nearer one, in metres. Single precision
/// resolves 0.2 micrometres there: in a substep of a millisecond, 0.2 mm/s, so that a light particle's share of the
/// momentum of a hit is not lost in rounding.
pub const RECENTRE_DISTANCE: f32 = 2.0;

/// Speed above which an obstacle's move counts as a teleport, which carries no velocity into contacts,
/// in metres per second: 25 m in a frame. Faster than anything a game swings.
pub const TELEPORT_SPEED: f32 = 1500.0;

/// Largest size, position or speed that a builder accepts (metres, metres per second): squares stay far
/// from the end of single precision.
pub const MAX_MAGNITUDE: f32 = 1.0e6;

/// Overlaps that were there before a substep are taken back at least at this speed, in metres per second. Slow
/// enough to throw nothing; fast enough that what rounding and round shapes leave is gone within the substep.
pub const PUSH_OUT_SPEED: f32 = 3.0;

/// The same for overlaps of faces and obstacles.
pub const GENTLE_PUSH_OUT_SPEED: f32 = 0.05;

/// A ball's centre that passes a face's plane within this part of its radius beside the face has passed through it.
/// Closes the cracks between neighbouring faces.
pub const PASSING_SLACK: f32 = 0.1;

/// A ball's centre that comes nearer to a face than this, in metres, may have passed through it: more than rounding can
/// hide within some metres of a body's origin, less than a part of the smallest ball.
pub const CLEARANCE: f32 = 1e-5;

/// Halvings of a substep in the search for a moment in which a ball's centre passes through a face. What cannot be told
/// in a thousandth of a substep counts as a passage.
pub const PASSAGE_HALVINGS: u32 = 10;

/// Two that meet slower than this, in metres per second, do not bounce: else what rests would tremble.
pub const RESTITUTION_SPEED: f32 = 0.2;

/// Where an obstacle could poke deeper than this between the particles of a cloth, in thicknesses, faces meet it too: up
/// to there the middle of the cloth stays outside.
pub const POKING: f32 = 1.0;

/// The distance that faces keep, in thicknesses: less than particles do, so that what lies flat lies on its particles
/// alone. With both at one distance they take turns, and the cloth trembles.
pub const FACE_THICKNESS: f32 = 0.5;

/// Rounds of the search for the deepest point of a face that runs through an obstacle when it is first seen in a step.
/// Each halves the way that is left, at least.
pub const DESCENT_ROUNDS: u32 = 16;

/// As [`CONTACT_MARGIN`], for faces, metres: they are looked at one by one, and many at the edge of a table.
pub const FACE_MARGIN: f32 = 0.01;

/// Rounds of projections to and fro in each substep, from where the deepest point was.
pub const LOOKS_AGAIN: u32 = 2;

/// A particle deeper in an obstacle than this, in sides of a face, has not got there by itself.
pub const INTRUSION: f32 = 0.5;

/// A deepest point with a greater weight than this is a corner, which is met as a particle.
pub const VERTEX_WEIGHT: f32 = 0.99;

/// Colours used to make batches of sticks that share no particle. A particle with more sticks than this in
/// one family puts the rest into a last batch that is relaxed in order.
pub const MAX_COLOURS: usize = 64;

/// Root mean square speed below which a body counts as still, in metres per second. A curtain of three metres
/// that swings slower than this for a second moves less than two centimetres to either side.
pub const REST_SPEED: f32 = 0.02;

/// The search for faces near a ball is wider than needed by this part of its radius: it is taken anew only when contacts
/// have pushed things farther than that.
pub const SEARCH_MARGIN: f32 = 0.03;
