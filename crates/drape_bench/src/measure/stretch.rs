//! Stretch of structural sticks.

use drape_solver::glam::Vec3;

use crate::scenes::model::Model;

/// Strains of structural sticks, `|length / rest length - 1|`.
#[derive(Clone, Copy, Debug, Default)]
pub struct StretchFigures {
    /// Root of the mean square.
    pub rms: f64,
    /// 99th percentile.
    pub p99: f64,
    /// The greatest value.
    pub max: f64,
}

/// The structural sticks of a body, ready to be measured.
pub struct StretchGauge {
    sticks: Vec<([usize; 2], f64)>,
    particles: usize,
    strains: Vec<f64>,
}

impl StretchGauge {
    /// A gauge for bodies of this model.
    pub fn new(model: &Model) -> Self {
        let measured = |stick: [u32; 2]| (stick.map(|end| end as usize), f64::from(model.rest_length(stick)));
        Self {
            sticks: model.structural().map(measured).collect(),
            particles: model.positions.len(),
            strains: Vec::new(),
        }
    }

    /// The stretch of all bodies. `positions` are those of their particles in metres, body after body.
    pub fn read(&mut self, positions: &[Vec3]) -> StretchFigures {
        let Self { sticks, particles, strains } = self;
        strains.clear();
        for body in positions.chunks(*particles) {
            strains.extend(sticks.iter().map(|&([a, b], rest)| {
                let (p, q) = (body[a].as_dvec3(), body[b].as_dvec3());
                (p.distance(q) / rest - 1.0).abs()
            }));
        }
        let rms = (strains.iter().map(|s| s * s).sum::<f64>() / strains.len() as f64).sqrt();
        let index = (strains.len() - 1) * 99 / 100;
        let (_, &mut p99, above) = strains.select_nth_unstable_by(index, f64::total_cmp);
        let max = above.iter().copied().fold(p99, f64::max);
        StretchFigures { rms, p99, max }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenes::rope::rope;

    #[test]
    fn one_stretched_link_is_seen() {
        let rope = rope(101);
        let mut gauge = StretchGauge::new(&rope);
        assert!(gauge.read(&rope.positions).max < 1e-5);
        let mut positions = rope.positions;
        // The last link of the second of two ropes is stretched by a half.
        positions.extend_from_within(..);
        positions[201].x += 0.01;
        let figures = gauge.read(&positions);
        assert!((figures.max - 0.5).abs() < 1e-4, "{figures:?}");
        assert!((figures.rms - 0.5 / 200_f64.sqrt()).abs() < 1e-4, "{figures:?}");
        assert!(figures.p99 < 1e-4, "{figures:?}");
    }
}
