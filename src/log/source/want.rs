//! What is wanted of a file.

/// What is wanted of a file.
#[derive(Clone, Copy, Debug)]
pub(in crate::log) enum Want<'a> {
    /// The log of one joint.
    One,
    /// One joint of several.
    Joint(&'a str),
    /// All joints.
    Robot,
    /// Whatever there is.
    Any,
}
