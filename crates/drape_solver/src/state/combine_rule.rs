//! The rule by which the coefficients of two surfaces become one.

#[cfg(feature = "bevy")]
use bevy_reflect::std_traits::ReflectDefault;

/// Makes one coefficient of the friction or restitution of an obstacle and that of what touches it. Two bodies, or two
/// balls, take the [`Average`](Self::Average).
///
/// ```
/// use drape_solver::{CombineRule, Obstacle};
///
/// // Ice: slippery for all that touches it.
/// let ice = Obstacle::ground().with_combine_rules(CombineRule::Min, CombineRule::Average);
/// # let _ = ice;
/// assert_eq!(CombineRule::ClampedSum.combine(0.8, 0.7), 1.0);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "bevy", derive(bevy_reflect::Reflect), reflect(Default, Debug, Clone, PartialEq))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum CombineRule {
    /// The mean of both.
    #[default]
    Average,
    /// The root of their product.
    GeometricMean,
    /// The smaller one.
    Min,
    /// Their product.
    Multiply,
    /// The larger one.
    Max,
    /// Their sum, at most 1.
    ClampedSum,
}

impl CombineRule {
    /// The coefficient of two surfaces with coefficients `a` and `b`, 0 or more.
    pub fn combine(self, a: f32, b: f32) -> f32 {
        match self {
            Self::Average => 0.5 * (a + b),
            Self::GeometricMean => (a * b).sqrt(),
            Self::Min => a.min(b),
            Self::Multiply => a * b,
            Self::Max => a.max(b),
            Self::ClampedSum => (a + b).min(1.0),
        }
    }
}
