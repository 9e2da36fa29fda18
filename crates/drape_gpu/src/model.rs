//! The rest data of bodies, as the shaders read it: batches of sticks, tethers, and the faces around each particle.

use drape_solver::constraint::stick::iteration_stiffness;
use drape_solver::state::drag::Drag;
use drape_solver::{BodySettings, GridFamily, StickBatch, StickBound, StickMaterial, Topology};

use crate::error::GpuError;
use crate::layout::BatchData;
use crate::source::HALO;

/// The end of a list of tethers; in a fan, the third corner of a link.
const NONE: u32 = u32::MAX;

/// A topology in pairs of words. Offsets count from the first of them.
#[derive(Clone, Debug)]
pub(crate) struct Model {
    pub pairs: Vec<[u32; 2]>,
    pub way: Way,
    pub batches: Vec<ModelBatch>,
    pub first_tether: u32,
    pub tethers_per_particle: u32,
    pub first_fan: u32,
    pub particle_count: u32,
    /// Columns and rows of a grid.
    pub grid: Option<[u32; 2]>,
    /// True if the air pushes on its squares.
    pub has_squares: bool,
}

/// Sticks that share no particle, with a stiffness that the step decides.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ModelBatch {
    pub material: StickMaterial,
    pub data: BatchData,
}

/// The ways to step a body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Way {
    /// One workgroup of this size class takes the whole step. Both ends of a stick fit into a word.
    Small(usize),
    /// Dispatches for each batch of sticks.
    Listed,
    /// Tiles, which know the sticks of a grid by their places, and need no list.
    Tiled,
}

impl Model {
    /// The pairs of a topology, for a body of this size class; none is a large one. `has_tiles` tells whether the device has memory for them.
    ///
    /// # Errors
    /// [`GpuError::Unsupported`] if it has what the shaders do not solve.
    pub fn new(topology: &Topology, size_class: Option<usize>, has_tiles: bool) -> Result<Self, GpuError> {
        if topology.has_bending_rigidity() {
            return Err(GpuError::Unsupported("cloth with a bending rigidity"));
        }
        if topology.has_membrane() {
            return Err(GpuError::Unsupported("cloth with a membrane stiffness"));
        }
        if !topology.embedded().is_empty() {
            return Err(GpuError::Unsupported("a rigid body"));
        }
        let count = topology.particle_count();
        let mut model = Self {
            pairs: Vec::new(),
            way: match size_class {
                Some(class) => Way::Small(class),
                None if has_tiles && fits_tiles(topology) => Way::Tiled,
                None => Way::Listed,
            },
            batches: Vec::new(),
            first_tether: 0,
            tethers_per_particle: 0,
            first_fan: 0,
            particle_count: count as u32,
            grid: topology.grid_size().map(|size| size.map(|side| side as u32)),
            has_squares: topology.has_squares(),
        };
        model.push_sticks(topology);
        model.push_tethers(topology);
        model.push_fans(topology);
        Ok(model)
    }

    fn push_sticks(&mut self, topology: &Topology) {
        // A batch whose sticks share particles is parted into colours; families of grids are parted already.
        let mut colours_at = vec![0_u64; topology.particle_count()];
        for batch in stiff_batches(topology) {
            if batch.family().is_some() {
                self.push_batch(topology, batch, batch.range());
                continue;
            }
            let mut coloured: Vec<Vec<usize>> = Vec::new();
            colours_at.fill(0);
            let mut rest: Vec<usize> = batch.range().collect();
            while !rest.is_empty() {
                // Sixty-four colours at a time: the centre of a star may need more.
                let first = coloured.len();
                let mut left = Vec::new();
                for stick in rest {
                    let ends = topology.stick(stick).map(|end| end as usize);
                    let taken = colours_at[ends[0]] | colours_at[ends[1]];
                    let colour = taken.trailing_ones() as usize;
                    if colour == 64 {
                        left.push(stick);
                        continue;
                    }
                    coloured.resize_with(coloured.len().max(first + colour + 1), Vec::new);
                    coloured[first + colour].push(stick);
                    ends.iter().for_each(|&end| colours_at[end] |= 1 << colour);
                }
                rest = left;
                colours_at.fill(0);
            }
            for sticks in coloured {
                self.push_batch(topology, batch, sticks.into_iter());
            }
        }
    }

    fn push_batch(
        &mut self,
        topology: &Topology,
        batch: &StickBatch,
        sticks: impl ExactSizeIterator<Item = usize>,
    ) {
        let material = batch.material;
        let (first, count) = (self.pairs.len() as u32, sticks.len() as u32);
        let words = |stick| (topology.stick(stick), topology.rest_length(stick).to_bits());
        match self.way {
            Way::Small(_) => {
                self.pairs
                    .extend(sticks.map(words).map(|([a, b], rest_length)| [a | (b << 16), rest_length]));
            }
            Way::Listed => self.pairs.extend(sticks.map(words).flat_map(|(ends, rest)| [ends, [rest, 0]])),
            Way::Tiled => {}
        }
        let mut data = BatchData {
            first,
            count,
            side: match material.bound {
                StickBound::Exact => 0,
                StickBound::AtLeast => -1,
                StickBound::AtMost => 1,
            },
            ..BatchData::default()
        };
        if let Some(family) = batch.family() {
            data.right = family.right;
            data.down = family.down as i32;
            data.phase = family.phase;
            data.rest_length = family.rest_length;
        }
        self.batches.push(ModelBatch { material, data });
    }

    /// Tethers as one column of (pin, length) for the first of each particle, one for the second, and so on.
    fn push_tethers(&mut self, topology: &Topology) {
        let tethers = topology.tethers();
        let count = topology.particle_count();
        let mut of_particle: Vec<Vec<(u32, f32)>> = vec![Vec::new(); count];
        for (particle, pin, length) in tethers {
            of_particle[particle as usize].push((pin, length));
        }
        let most = of_particle.iter().map(Vec::len).max().unwrap_or(0);
        self.first_tether = self.pairs.len() as u32;
        self.tethers_per_particle = most as u32;
        for tie in 0..most {
            for own in &of_particle {
                let tether = own.get(tie).map_or([NONE, 0], |&(pin, length)| [pin, length.to_bits()]);
                self.pairs.push(tether);
            }
        }
    }

    /// For each particle the range of its fan, counted from the first pair of the list. A fan has the two other corners of each face around
    /// the particle, in the face's order, or the other end of a link.
    fn push_fans(&mut self, topology: &Topology) {
        let count = topology.particle_count();
        let mut fans = fans_of(topology.faces(), count);
        for &[a, b] in topology.segments() {
            fans[a as usize].push([b, NONE]);
            fans[b as usize].push([a, NONE]);
        }
        self.first_fan = self.pairs.len() as u32;
        self.pairs.extend(ranges_of(&fans));
        self.pairs.extend(fans.iter().flatten());
    }

    /// The batches for a step of `dt` seconds with these settings, in a buffer where the model's pairs begin at `first_pair`.
    pub fn batches(
        &self,
        settings: &BodySettings,
        dt: f32,
        first_pair: u32,
    ) -> impl Iterator<Item = BatchData> {
        let substep = dt / settings.substeps as f32;
        let effective = Drag::new(settings.drag, substep).effective_substep(substep);
        self.batches.iter().map(move |batch| BatchData {
            first: first_pair + batch.data.first,
            stiffness: iteration_stiffness(batch.material.stiffness, effective, settings.iterations),
            ..batch.data
        })
    }
}

/// The fan of each of `count` corners: the two other corners of each face around it, in the face's order.
pub(crate) fn fans_of(faces: &[[u32; 3]], count: usize) -> Vec<Vec<[u32; 2]>> {
    let mut fans = vec![Vec::new(); count];
    for &[a, b, c] in faces {
        for [first, second, third] in [[a, b, c], [b, c, a], [c, a, b]] {
            fans[first as usize].push([second, third]);
        }
    }
    fans
}

/// The ranges of fans that lie one after another behind their ranges, counted from the first range.
pub(crate) fn ranges_of(fans: &[Vec<[u32; 2]>]) -> impl Iterator<Item = [u32; 2]> {
    fans.iter().scan(fans.len() as u32, |next, fan| {
        let first = *next;
        *next += fan.len() as u32;
        Some([first, *next])
    })
}

/// Batches with sticks that act.
fn stiff_batches(topology: &Topology) -> impl Iterator<Item = &StickBatch> {
    topology.batches().iter().filter(|batch| batch.count > 0 && batch.material.stiffness > 0.0)
}

/// True if the topology is a grid on which one iteration stays within a tile's halo.
fn fits_tiles(topology: &Topology) -> bool {
    let families = || stiff_batches(topology).filter_map(StickBatch::family);
    // Sticks along a row begin at their left ends.
    let is_fit =
        |GridFamily { right, down, .. }: GridFamily| right.abs() <= 2 && down <= 2 && (down > 0 || right > 0);
    topology.grid_size().is_some()
        && families().all(is_fit)
        && families().map(|family| family.right.unsigned_abs()).sum::<u32>() <= HALO
        && families().map(|family| family.down).sum::<u32>() <= HALO
}
