//! The work of self-contact, in numbers.

/// The work of [self-contact](crate::BodySettings::self_contact) in a step; see
/// [`Island::self_contact_counts`](crate::Island::self_contact_counts).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct SelfContactCounts {
    /// Pairs that are watched at the end of the step; the cost grows with them.
    pub pairs: usize,
    /// Lists of pairs that were made.
    pub lists: u32,
    /// Edges that passed through faces when the step began.
    pub crossings: u32,
    /// Times that two parts were moved back because they would have passed each other.
    pub truncated: u32,
    /// Substeps in which some parts could not be kept from passing each other.
    pub unfinished: u32,
}
