//! Tolerances, bounds and tuning constants of the solver, each with its unit and the reason for its value.
//!
//! A constant that a single file or folder uses may stand there instead, beside its use; many do.
//!
//! ```
//! use drape_solver::constants::{MAX_MAGNITUDE, REFERENCE_STEP};
//! use drape_solver::{BodySettings, BuildError, ClothBuilder};
//!
//! // Stiffness says how much of its strain a stick loses in one frame of a 60 Hz game.
//! assert_eq!(REFERENCE_STEP, 1.0 / 60.0);
//! // Builders refuse what squares in single precision would not hold.
//! let huge = ClothBuilder::new(2.0 * MAX_MAGNITUDE, 1.0, 8, 8).build(BodySettings::default());
//! assert!(matches!(huge, Err(BuildError::NotFinite { .. })));
//! ```

// Time, positions and rest

/// Time that stiffness values refer to, in seconds: a stick of stiffness `s` loses the fraction `s` of its strain in
/// one reference step. One frame of a 60 Hz game, the step that artists tune by.
pub const REFERENCE_STEP: f32 = 1.0 / 60.0;

/// Substep assumed until a body is first stepped, in seconds. Any value does: displacements are rescaled when the real
/// substep is known. A power of two keeps that rescaling free of rounding.
pub const INITIAL_SUBSTEP: f32 = 1.0 / 1024.0;

/// Largest size, position or speed that a builder accepts (metres, metres per second): squares stay far from the end of
/// single precision.
pub const MAX_MAGNITUDE: f32 = 1.0e6;

/// A body whose centre is farther than this from its local origin is given a nearer one, in metres. Single precision
/// resolves 0.2 micrometres there: in a substep of a millisecond, 0.2 mm/s, so that a light particle's share of the
/// momentum of a hit is not lost in rounding.
pub const RECENTRE_DISTANCE: f32 = 2.0;

/// Root mean square speed below which a body counts as still, in metres per second. A curtain of three metres that
/// swings slower than this for a second moves less than two centimetres to either side.
pub const REST_SPEED: f32 = 0.02;

/// Speed above which an obstacle's move counts as a teleport, which carries no velocity into contacts, in metres per
/// second: 25 m in a frame. Faster than anything a game swings.
pub const TELEPORT_SPEED: f32 = 1500.0;

// Bounds on the work of a step

/// Upper bound on substeps per step that a fast ball can cause: bounds the work of a step.
pub const MAX_SUBSTEPS: u32 = 256;

/// Upper bound on substeps per step that a heavy ball near a light cloth can cause: `contact/ball_cloth.rs` has the
/// formula.
pub const MAX_HIT_SUBSTEPS: f32 = 256.0;

/// The part of the substeps of a hit that a ball near a cloth keeps from step to step while it needs fewer.
pub const HIT_SUBSTEPS_KEPT: f32 = 0.9;

/// A ball may cross at most this fraction of its radius in one substep; faster balls get more substeps. At one half, a
/// ball's centre cannot pass a face between two projections.
pub const BALL_TRAVEL_PER_SUBSTEP: f32 = 0.5;

/// Upper bound on relaxation iterations per substep: bounds the work of a step.
pub const MAX_ITERATIONS: u32 = 1024;

// Sticks, lines and tethers

/// Colours used to make batches of sticks that share no particle. A particle with more sticks than this in one family
/// puts the rest into a last batch that is relaxed in order.
pub const MAX_COLOURS: usize = 64;

/// Particles from which on an irregular body is renumbered: smaller ones stay in the nearest cache anyway.
pub const LEAST_RENUMBERED: usize = 256;

/// Part of its diagonal that a [line solve](crate::StructuralSolve::Lines) adds to its matrix. A straight chain between
/// two pins has one stick too many for its particles: without this its matrix has no inverse. Costs a loaded line a
/// hundredth of a per cent of stretch.
pub const CHAIN_REGULARISER: f32 = 1e-4;

/// The same for sticks with a compliance, which is all that they need but for rounding.
pub(crate) const ELASTIC_REGULARISER: f32 = 2e-6;

/// Mean strain of its rigid sticks above which a line of cloth no longer takes its whole step: what pulls so hard may not give way, and
/// lines that cannot all have their lengths would throw each other to and fro.
pub(crate) const OVERSTRETCHED: f32 = 0.05;

/// Strain of its longest rigid stick above which a rope, or another line that is solved alone, no longer takes its whole step.
pub(crate) const OVERSTRETCHED_STICK: f32 = 0.1;

/// A line takes one part in `1 + EASING e` of its step, with `e` the strain above that. With half as much, more cloth that is pulled too far
/// trembles.
pub(crate) const EASING: f32 = 200.0;

/// Substeps up to which rigid columns are solved once more after the rows, which leaves the less stretch the fewer there are. With 64
/// substeps hanging grids of 9 x 9 to 12 x 12 gain energy by it.
pub(crate) const MOST_SUBSTEPS_OF_TWO_COLUMNS: u32 = 12;

/// Greatest move of the ends of a stick against each other in a line solve, in rest lengths. The solve treats sticks as
/// straight; one that turns by more than this ends longer than it was.
pub const CHAIN_STEP: f32 = 0.5;

/// Pull over length and mass, times the square of a substep, from which on a line solve also turns its sticks implicitly. Explicit
/// turns along rows and columns together are unstable from 0.5 on, without what shear and bend sticks add.
pub(crate) const TAUT: f32 = 0.25;

/// In a line solve, inverse masses above this count as this, in 1/kg: single precision ends at 3e38.
pub(crate) const GREATEST_INVERSE_MASS: f32 = 1e30;

/// In a line solve, a stick whose ends have less inverse mass than this together counts as pinned at both, in 1/kg.
pub(crate) const LEAST_WEIGHT: f32 = 1e-30;

/// A particle that is joined to an obstacle is an ordinary pin if its inverse mass is below this part of the mean of its
/// body's free particles: the way by which sticks move it would be lost in rounding.
pub(crate) const LEAST_JOINT_WEIGHT: f32 = 1e-6;

/// Tethers kept for each particle: the nearest pins. More buy nothing that can be seen.
pub const MAX_TETHERS: usize = 4;

/// Tethers pull a particle back at this speed at most, in metres per second. A particle that hangs from a pin is pulled
/// by millimetres; one that was dragged a metre away must not come back as a bullet.
pub const TETHER_SPEED: f32 = 50.0;

/// Rounds in which the tethers of all that a rigid body presses pull at it, one after another.
pub(crate) const TETHER_PULL_ROUNDS: usize = 4;

/// Seconds in which the stretch of cloth that has stopped a rigid body goes down to `1 / e`. Quicker, it would throw the body back.
pub(crate) const TETHER_RECOVERY: f32 = 1.0;

/// Tethers leave particles within this many radii of a ball alone.
pub const TETHERLESS_REACH: f32 = 1.5;

// Limits on motion

/// A particle that is nearer than this to the end of its limit on motion is at it, in metres: the rounding of single
/// precision.
pub const AT_LIMIT: f32 = 1e-5;

/// Depth in metres below an obstacle's surface at which a particle's limit on motion counts as the reason.
pub const LIMIT_CONFLICT_DEPTH: f32 = 1e-3;

// Drives towards an animated pose

/// Greatest angular frequency of a pose drive in rad/s: a particle comes to its place within 1/1000 s.
pub const MAX_DRIVE_FREQUENCY: f32 = 1e4;

/// Greatest damping ratio of a pose drive.
pub const MAX_DAMPING_RATIO: f32 = 1e3;

// Sweeps and threads

/// Cells from which on a sweep runs down the strips of a grid: smaller bodies stay in the nearest cache anyway.
pub const LEAST_SWEPT_CELLS: usize = 128;

/// Cells that a stage takes at once in a sweep: enough to be worth the call, and few enough that those of all stages
/// stay in the nearest cache.
pub const CELLS_AT_ONCE: usize = 64;

/// Memory that a cell's particles, masses and tethers take up in a sweep, in bytes.
pub const BYTES_OF_CELL: usize = 800;

/// Memory that the strips between the first stage of a sweep and its last may take up, in bytes: the second cache of a
/// core.
pub const SWEPT_BYTES: usize = 3 << 19;

/// Cells for each thread from which on threads share a body.
pub const LEAST_SHARED_CELLS: usize = 400;

/// Cells with self-contact in an island from which on threads share the search for what touches.
pub const LEAST_TOUCHING_CELLS: usize = 64;

/// Cells for each thread from which on threads share the bodies of an island.
pub const LEAST_SHARED_BODIES: usize = 16;

/// Stars for each thread from which on threads share the bodies whose surfaces may touch.
pub const LEAST_SHARED_STARS: usize = 256;

/// Pairs of leaves for each thread from which on threads share the search for pairs of stars.
pub const LEAST_SHARED_LEAF_PAIRS: usize = 32;

/// Pairs of stars, or of parts, for each thread from which on threads share them: sharing costs about a microsecond, and a few more if
/// a helper must be woken.
pub const LEAST_SHARED_PAIRS: usize = 256;

/// Strips for each thread and strip of lag from which on threads share a body: one thread alone does the wedges between
/// their parts.
pub const LEAST_STRIPS_PER_LAG: usize = 8;

/// Cost of the contacts of a cell that may touch an obstacle, in parts of the cost of all other work on a cell.
pub const WORK_OF_CONTACTS: f32 = 0.5;

// Searches for contacts

/// Slack of the contact search, in metres: it still finds a particle this far beyond its reach, as sticks and balls can
/// push a particle faster within a step than it moved before.
pub const CONTACT_MARGIN: f32 = 0.05;

/// As [`CONTACT_MARGIN`], for faces, in metres: they are tested one by one, and many lie at the edge of a table.
pub const FACE_MARGIN: f32 = 0.01;

/// The search for faces near a ball is wider than needed by this part of its radius: it runs again only when contacts
/// have pushed things farther than that.
pub const SEARCH_MARGIN: f32 = 0.03;

// Overlap and restitution

/// Nearer to a surface than this part of a point's coordinates, rounding turns the direction to the surface by more
/// than a degree.
pub(crate) const SURFACE_NOISE: f32 = 1.0e-5;

/// Overlaps of particles and obstacles below this, in metres, are rounding.
pub const LEAST_OVERLAP: f32 = 1e-6;

/// Overlaps that were there before a substep are removed at least at this speed, in metres per second. Slow enough to
/// throw nothing; fast enough that the overlap by rounding and round shapes is gone within the substep.
pub const PUSH_OUT_SPEED: f32 = 3.0;

/// The same for overlaps of faces and obstacles.
pub const GENTLE_PUSH_OUT_SPEED: f32 = 0.05;

/// Cosine of the angle between two opposite pushes up to which friction keeps a particle from slipping out between them: 26 degrees.
pub const HELD_FAST: f32 = 0.9;

/// Contacts slower than this, in metres per second, do not bounce: else bodies at rest would tremble.
pub const RESTITUTION_SPEED: f32 = 0.2;

// Faces against obstacles

/// Depth in thicknesses to which an obstacle may poke between the particles of a cloth before its faces touch it too:
/// up to there the middle of the cloth stays outside.
pub const POKING: f32 = 1.0;

/// The distance that faces keep, in thicknesses: less than particles do, so that cloth that lies flat lies on its
/// particles alone. With both at one distance they take turns, and the cloth trembles.
pub const FACE_THICKNESS: f32 = 0.5;

/// Rounds of the search for the deepest point of a face that intersects an obstacle at the start of a step. Each halves
/// the remaining distance, at least.
pub const DESCENT_ROUNDS: u32 = 16;

/// Rounds of alternating projections in each substep, which follow the deepest point.
pub const LOOKS_AGAIN: u32 = 2;

/// A particle deeper in an obstacle than this, in sides of a face, did not move there: the obstacle appeared around it.
pub const INTRUSION: f32 = 0.5;

/// A deepest point with a greater weight than this is a corner, which the contact of particles handles.
pub const VERTEX_WEIGHT: f32 = 0.99;

// Balls against cloth

/// A ball's centre that passes a face's plane within this part of its radius beside the face has passed through it.
/// Closes the cracks between neighbouring faces.
pub const PASSING_SLACK: f32 = 0.1;

/// A ball's centre that comes nearer to a face than this, in metres, may have passed through it: more than rounding can
/// hide within some metres of a body's origin, less than a part of the smallest ball.
pub const CLEARANCE: f32 = 1e-5;

/// Halvings of a substep in the search for a moment in which a ball's centre passes through a face. A case that a
/// thousandth of a substep cannot decide counts as a passage.
pub const PASSAGE_HALVINGS: u32 = 10;

// Self-contact

/// Contacts that push in free flight, where a rope takes part, are those that come nearer than the distance that they keep,
/// times 1 and this more: sticks and contacts may yet push them together.
pub const MARGIN_IN_FREE_FLIGHT: f32 = 0.25;

/// A patch of cloth lies flat if the normals of all its faces lean to one side by at least this cosine.
pub const LEAST_FLAT_COSINE: f32 = 0.4;

/// Rounds in which contacts of cloth with cloth and with obstacles are projected in turn. Each round halves the weight
/// that two layers on an obstacle leave for the next substep: with one, the upper never comes to rest.
pub const ROUNDS_OF_LAYERS: u32 = 4;

/// Pushes of all rounds but the last are so many times what stops two layers: impulses reach through a heap in fewer rounds. Below 2
/// none adds energy; 1.5 and more leave noise that can be measured.
pub const OVER_RELAXATION: f32 = 1.3;

/// Speed at which layers that cross are led apart, in metres per second.
pub const UNTANGLING_SPEED: f32 = 0.5;

/// Contacts of surfaces are those that come nearer than the distance that they keep, times 1 and this more.
pub const CONTACT_MARGIN_OF_SURFACES: f32 = 0.05;

/// Substeps for which a list of surface pairs holds at most. Where something is hit a step has many, and what flies fast would have
/// all that lies on its way through the step in its list.
pub const MOST_LISTED_SUBSTEPS: u32 = 8;

/// Distance that a corner may be off the way that a list of surface pairs expects, in distances that contacts keep. More
/// makes longer lists, less makes more of them.
pub const SLACK_OF_SURFACES: f32 = 0.25;

/// The same where nothing is near and nothing is listed.
pub const SLACK_OF_CALM: f32 = 1.0;

/// Part of their distance that edges keep which lie flat between their faces: corners on faces hold flat layers apart.
pub const BLUNT_EDGES: f32 = 0.3;

/// Parts of one body keep this part of their distance at rest at most.
pub const REST_SHARE: f32 = 0.5;

/// Pairs are watched for passing if the plane between them is left a gap narrower than this, in distances that the thinnest
/// keep. More makes more of them, less has more looked at again at the end of a substep.
pub const RISKY_GAP: f32 = 0.4;

/// Speed at which surfaces that are too near at the start of a substep are led apart, in metres per second.
pub const RECOVERY_SPEED: f32 = 0.2;

/// Square of the cosine of the angle, 18 degrees, within which a bend's rest and its weighted sum count as along one line.
pub const ALONG_ONE_LINE: f32 = 0.9;
