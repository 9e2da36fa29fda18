//! Recordings: what a run did, step by step, in one compact file.
